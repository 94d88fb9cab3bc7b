"""One episode from a world file and a seed: positions first, then bodies."""
