"""What a renderer needs of a model, as plain structs with named arrays."""
