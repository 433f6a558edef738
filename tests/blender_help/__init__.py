"""What several tests need of Blender: materials, a recorder of panels, scenes, processes."""
