"""Benches: many episodes of a tree, each in a process, their rows, and statistics of them."""
