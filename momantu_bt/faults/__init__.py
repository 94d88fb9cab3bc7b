"""Break a run on purpose: names of faults, when they begin, and what they do."""
