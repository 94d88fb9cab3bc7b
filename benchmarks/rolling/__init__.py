"""A world without physics: a bundled robot that rolls among the bodies of a world file."""
