"""Plan a bench: which episodes are wanted, what each depends on, and which exist already."""
