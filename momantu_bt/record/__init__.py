"""A run on paper: its fingerprint, its report, its log of changes."""
