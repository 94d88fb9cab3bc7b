"""What a robot can do: skills, services, and the libraries they stand on."""
