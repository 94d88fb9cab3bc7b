"""People who walk about: where they can walk, how they move, and their bodies in the simulator."""
