"""States of the hand that are made on purpose, and what the hand is believed to hold in them."""
