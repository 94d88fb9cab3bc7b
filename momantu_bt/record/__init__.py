"""What remains of a run: its fingerprint, its report and its record, written and read back."""
