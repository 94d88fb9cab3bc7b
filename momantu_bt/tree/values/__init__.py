"""What a port's value may be: types, units, and text turned into values."""
