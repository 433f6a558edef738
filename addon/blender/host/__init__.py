"""Blender as a host: settings, folders, the cache on disk, translation, redrawing."""
