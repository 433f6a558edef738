"""Numbers of Cycles' closures in base lobes, shared by the fits in Python and by the shaders."""

LEVELS = 8  # colors of a phong_ramp
SLOTS = LEVELS + 1  # numbers of a ramp in the table of base lobes: its levels, and one more
SHARPEST = 5e5  # largest exponent of a crease's phong_ramp: single precision resolves no larger one
# Largest lean of a facet times the lobe's width: before Blender 5, Cycles lights such facets from below the horizon.
LEANEST = 0.02
NARROWEST_FACET = 5e-4  # least width of microfacets: Cycles treats narrower ones as mirrors

# The largest lean of a ramp's axis, in radians: Cycles bends closures that mirror into the surface.
# Away from the normal it is LEAN_DOWN times the mirror direction's height above LEAN_MARGIN.
LEAN_DOWN = 0.6
LEAN_MARGIN = 0.03
# Towards the normal and beyond it is LEAN_UP less than the angle to the horizon on the view's side.
LEAN_UP = 0.3
# The axis of a ramp whose crease goes through the mirror direction.
CREASE_LEAN = 0.1  # least lean, in the lobe's widths
CREASE_COSINE = 0.03  # least cosine of that lean: its logarithm is a divisor

# The coordinate of a view among the nodes of a fit, u = share w / (1 + w) + theta / pi.
VIEW_SLOPE_SHARE = 0.5  # share of w, the slope at the crease in parts of the lobe's width

NEGATIVE_EDGE = 1.3  # where a negative kernel ends, in parts of its radius: the end is above the horizon

# A half-vector lobe, and the Phong lobe of equal width.
PHONG_PER_HALF = 0.25  # exponent of the Phong lobe, in parts of the half-vector lobe's
HALF_WIDTH = PHONG_PER_HALF**-0.5  # width of the half-vector lobe times the root of its exponent
GRAZING_WIDTH = 0.15  # cosine by which it is wider at grazing, across the plane, in parts of its width
