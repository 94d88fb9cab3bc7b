"""Checks of a robot's file."""
