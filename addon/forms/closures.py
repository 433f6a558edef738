"""Numbers of Cycles' closures as base lobes use them, in the fits in Python and in the shaders alike."""

LEVELS = 8  # colours of a phong_ramp
SLOTS = LEVELS + 1  # numbers of a ramp in the table of base lobes: its levels, and one more
SHARPEST = 5e5  # exponent of a crease's phong_ramp: single precision knows no more
LEANEST = 0.02  # lean of a facet times the lobe's width: before Blender 5, Cycles lights them from below the horizon
NARROWEST_FACET = 5e-4  # width of microfacets: Cycles takes narrower ones for mirrors

# How far the axis of a ramp may lean, in radians: Cycles bends closures that mirror into the surface.
LEAN_DOWN = 0.6  # away from the normal, in parts of the mirror direction's height above the horizon,
LEAN_MARGIN = 0.03  # which counts from here
LEAN_UP = 0.3  # towards the normal and beyond, this much less than to the horizon on the view's side
# The axis of a ramp whose crease goes through the mirror direction.
CREASE_LEAN = 0.1  # least lean, in the lobe's widths
CREASE_COSINE = 0.03  # of that lean, at least: its logarithm is divided by

# The coordinate of a view among the nodes of a fit, u = share w / (1 + w) + theta / pi.
VIEW_SLOPE_SHARE = 0.5  # of w, the slope at the crease in parts of the lobe's width

NEGATIVE_EDGE = 1.3  # where a negative kernel ends, in parts of its radius: above the horizon

# The Phong lobe that is as wide as a half-vector lobe.
PHONG_PER_HALF = 0.25  # its exponent, in parts of the half-vector lobe's
HALF_WIDTH = PHONG_PER_HALF**-0.5  # width of the half-vector lobe, times the root of its exponent
GRAZING_WIDTH = 0.15  # cosine by which it stays wider at grazing, across the plane, in parts of its width
