"""Where to stand, and the path there."""
