"""A whole trip: the vehicle, its moves, cruising, arriving, recovering."""
