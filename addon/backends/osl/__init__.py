"""The OSL backend's text: shared numbers, signatures, and the assembled shader of a model."""
