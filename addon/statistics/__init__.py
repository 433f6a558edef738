"""Statistical tests of samplers."""
