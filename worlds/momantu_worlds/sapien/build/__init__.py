"""Bodies and robots built in a SAPIEN scene, and their ground truth."""
