"""The ground floor: files, formats and mistakes in them, for framework, skills and worlds.

Nothing here knows trees, robots or worlds, and nothing here imports another room.
"""
