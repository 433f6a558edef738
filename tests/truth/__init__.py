"""Independent references for the tests: formulas and quadratures that share no code with the extension."""
