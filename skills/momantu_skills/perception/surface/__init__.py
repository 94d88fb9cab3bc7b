"""The surface that things stand on: its plane, the things above it, free spots."""
