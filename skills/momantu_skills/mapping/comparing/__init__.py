"""Two maps of one place: how they lie to each other, and where they differ."""
