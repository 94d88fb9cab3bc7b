"""From a path to velocities: MPPI, the graceful controller, the collision guard."""
