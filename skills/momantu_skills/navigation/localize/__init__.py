"""Localization: Monte Carlo localization, and when its estimate is reliable."""
