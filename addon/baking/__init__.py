"""Computes, writes, reads and checks the albedo tables. Never imports bpy."""
