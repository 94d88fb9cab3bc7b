"""Faults of the surroundings: what only the world can make, from ground truth.

Each module is one idea. `rows` lists the faults by name; `stage` is what all of them work on.
"""
