"""Localization, costmaps, planning and control for a base that drives forward and turns."""
