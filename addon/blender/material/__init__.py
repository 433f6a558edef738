"""Plausible materials: their node, its sockets and program, and edits, bakes, upgrades and repairs of them."""
