"""Presets and measured metals."""
