"""Localization: Monte Carlo localization, and how far to trust it."""
