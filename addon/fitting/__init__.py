"""Parameters that make one model look like another or like data: by matching the lobe's width, or by fitting."""
