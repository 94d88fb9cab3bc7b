"""Draw one episode from a world file and a seed: poses first, then bodies."""
