"""A model at a glance, quick enough to follow a slider: albedos, lobes, and a picture of both, with NumPy alone."""
