"""Helpers for tests in Blender: materials, a recorder of panels, scenes, processes."""
