"""Nav2's leaves that need no more than the robot's pose: selectors, conditions, paths, goals."""
