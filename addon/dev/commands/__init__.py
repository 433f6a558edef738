"""Commands of `plausible` in a checkout, which the extension lacks."""
