"""Tests whether a .blend renders elsewhere, and lists the files that it needs there."""
