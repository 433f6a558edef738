"""What shader nodes render: Principled BSDFs that come nearest to a model."""
