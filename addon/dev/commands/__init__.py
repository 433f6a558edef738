"""Commands of `plausible` that a checkout has and the extension lacks."""
