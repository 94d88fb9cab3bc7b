"""The learned detector: what each pixel shows, by a network, then poses and sizes from depth."""
