"""Kinds of faults: their rows, the catalogue, and their triggers and reasons among the skills."""
