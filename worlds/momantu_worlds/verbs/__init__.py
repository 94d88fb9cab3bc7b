"""Verbs of this package; heavy imports are lazy."""
