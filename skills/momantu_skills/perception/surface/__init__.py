"""The surface that objects stand on: its plane, the objects on it, free spots."""
