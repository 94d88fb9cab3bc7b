"""Where the robot is: Monte Carlo localization and how far to trust it."""
