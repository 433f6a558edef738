"""Which parameters make one model look like another, or like data: matched by the lobe's width, or fitted."""
