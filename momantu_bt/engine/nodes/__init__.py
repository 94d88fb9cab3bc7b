"""The classes of the built-in nodes, by canonical type."""
