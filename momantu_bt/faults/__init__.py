"""Breaking a run on purpose: what a fault is called, when it begins, and how it is made."""
