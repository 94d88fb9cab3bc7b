"""A robot file from what was found."""
