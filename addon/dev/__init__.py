"""Tools of a checkout, which the extension lacks: demos, figures, benchmarks, pages, packaging."""
