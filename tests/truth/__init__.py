"""What the product is held against: formulas and quadratures that share no code with it."""
