"""Properties of the models, computed from their formulas, and what has been published about them."""
