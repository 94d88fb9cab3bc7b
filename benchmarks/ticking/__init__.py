"""The trees that `tick.py` measures."""
