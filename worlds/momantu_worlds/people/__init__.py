"""People who walk about: where they can walk, and how they move."""
