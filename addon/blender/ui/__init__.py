"""What a user sees: panels, operators, menus, properties, preferences."""
