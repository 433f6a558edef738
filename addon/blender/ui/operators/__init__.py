"""Operators, one file for each feature."""
