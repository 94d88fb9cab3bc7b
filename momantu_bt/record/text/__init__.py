"""Runs as lines of text: the tree, changes, failures and how a run ended."""
