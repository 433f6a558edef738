"""Makes pages of the manual from the registry, and checks the links of all pages. Never imports bpy."""
