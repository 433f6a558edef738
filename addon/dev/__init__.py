"""What makes and measures the project and is not in the extension: demos, figures, benchmarks, pages, packaging."""
