"""How well detectors find things in labelled pictures."""
