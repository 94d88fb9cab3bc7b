"""Furniture, loose objects and AprilTags that a world file names by their kind."""
