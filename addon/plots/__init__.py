"""Plots of a model's albedo and lobes, by NumPy alone and fast enough to follow a slider."""
