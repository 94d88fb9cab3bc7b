"""A run on paper: its fingerprint, its report, its record, written and read back."""
