"""Reads YAML 1.2 as values with their places in the file, without recursion, with size limits."""
