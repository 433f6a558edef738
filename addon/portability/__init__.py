"""What a .blend needs elsewhere."""
