"""Where robots act: robots, scenes and the simulator."""
