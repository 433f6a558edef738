"""Services on top of Blender: settings, folders, the cache on disk, translation, redrawing."""
