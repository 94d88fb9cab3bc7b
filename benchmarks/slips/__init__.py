"""Slips that people make in tree files, and whether the checker finds them."""
