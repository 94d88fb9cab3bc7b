"""World files, their episodes, sites and referee; no simulator."""
