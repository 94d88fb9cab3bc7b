"""Scenes: world files, what fills them, what varies, maps, and the referee."""
