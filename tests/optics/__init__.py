"""Directions, scenes and statistics for the tests that measure reflectance."""
