"""Faults of the surroundings, which only the world can cause, from ground truth.

Each module is one kind of fault or a helper. `rows` lists the faults by name; `stage` holds what
all of them work on.
"""
