"""Plots of the models, a module for each set: `SET` names the figures, `draw(name)` returns one. Never imports bpy."""
