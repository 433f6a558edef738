"""The user interface: panels, operators, menus, properties, preferences."""
