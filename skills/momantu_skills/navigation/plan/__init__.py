"""Where to stand, and the way there."""
