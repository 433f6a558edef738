"""Albedo tables: their axes and files, reading them, and baking them."""
