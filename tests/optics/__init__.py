"""Directions, scenes and statistics that several tests measure reflectance with."""
