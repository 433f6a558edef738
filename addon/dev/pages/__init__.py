"""Pages of the manual that are made from the registry, and whether what pages refer to is there. Never imports bpy."""
