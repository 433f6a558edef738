"""From the files in `osl` to the text of one self-contained shader. Never imports bpy."""
