"""Making and checking the extension's zip. Importing it never imports bpy."""
