"""The world file of an import: proposals for its site, and its text."""
