"""Statistics on samplers."""
