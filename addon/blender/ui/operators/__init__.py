"""Operators, one feature a file."""
