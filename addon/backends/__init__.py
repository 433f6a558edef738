"""From a form to something that a renderer runs, without Blender."""
