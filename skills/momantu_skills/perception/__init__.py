"""What a robot sees: looking, clouds, planes, things on them, tags."""
