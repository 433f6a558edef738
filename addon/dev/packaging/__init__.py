"""Making and checking the extension's zip. Never imports bpy itself."""
