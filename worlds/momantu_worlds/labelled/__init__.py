"""Labelled pictures of heaps of things, made for training and measuring detectors."""
