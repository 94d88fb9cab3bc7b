"""Reads XML as elements with their places in the file, without recursion and with size limits."""
