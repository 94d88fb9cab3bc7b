"""XML as elements that know their place: read without recursion and within bounds."""
