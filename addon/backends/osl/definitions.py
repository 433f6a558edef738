"""The macros that the assembler writes in front of a shader besides the shared numbers: by model, and hooks.

Each macro that a shader expects and does not define itself is in `constants.SHARED`, `MODEL` or `HOOKS`, or is LEAST_,
MOST_ or DEFAULT_ followed by the id of a parameter.
"""

# {macro: meaning}. A model has the macros that its shader expects.
MODEL = {
    # The signature, and the declaration's choices.
    "MODEL": "the model's id",
    "MODEL_PARAMETERS": "inputs, with the declared types and defaults",
    "DATA_PARAMETERS": "inputs that are arrays of numbers, or paths of tables",
    "PROJECTION": "projection of lumps on the disk: SCALING or ORTHOGONAL",
    "HELD_RADII": "1 where a lump is shrunk until it is on the disk",
    # Albedo tables: numbers, or files that texture() reads.
    "TABLE_FILE": "defined where texture() reads the tables",
    "AXES_PLAIN": "axes of the table of plain albedos",
    "AXES_CONTROLLED": "axes of the table of controlled albedos",
    "AXES_VOLUME": "axes of the table of volumes",
    "TABLE_NAME_PLAIN": "the tables' names in messages",
    "TABLE_NAME_CONTROLLED": "",
    "TABLE_NAME_VOLUME": "",
    "VOLUME_LAYERS": "number of radii of the table of volumes",
    # The table of bells.
    "BELLS_ROW": "numbers of a row of the table of bells",
    "STEEP_ROWS": "offset of the first row of steep lumps",
    "STEEP_ROW": "numbers of a row of steep lumps",
    "STEEP_KNOTS": "offset of the knots in such a row",
    # Base lobes of a family.
    "BASE_U": "number of nodes of the view",
    "BASE_V": "number of nodes of the exponent",
    "BASE_POWER": "power of 1/n in which the exponent's nodes are evenly spaced",
    "BASE_FEATURES": "number of cosines at which the gain is read",
    "BASE_GRAZING": "height of the mean of N.L at grazing above N.V, in parts of the lobe's width",
    "BASE_DRAWN": "exponent of the lobe that kernels are sampled from, in parts of n",
    "BASE_NEGATIVE_RADIUS": "radius of the widest negative kernels, in parts of the lobe's width",
    "BASE_SETS": "number of sets of a ramp's levels",
    "BASE_STRIDE": "vectors of one gain of one node",
    "BASE_LEVELS": "numbers of all sets of levels",
    "BASE_RAMPS": "number of ramps",
    "BASE_FACETS": "number of microfacets",
    "BASE_FACET_ROOM": "length of the microfacets' arrays, at least 1",
    "BASE_PLAIN": "1 where phong_ramp itself is the lobe",
    # Lobe rows of a baked model.
    "MODEL_LABEL": "the model's name in messages",
    "MODEL_MATCHES": "condition that the inputs have the values of the bake",
    "W_VIEWS": "rows of one azimuth",
    "W_AZIMUTHS": "azimuths of views",
    "W_WHOLE": "1 where the azimuths go all around",
    "W_RINGS": "rings of cells",
    "W_AROUND": "cells of a ring",
    "W_CHANNELS": "energies of a cell",
    "W_SPIKES": "colors of the mirror from row to row, 0 without a spike",
    "W_RANGES": "number of driven parameters",
    "W_SETS": "number of sets of rows, one for each combination of steps",
    "RANGE_PLACES": "position of each driven parameter among its steps",
    "RANGE_STEPS": "number of steps of each driven parameter",
    "RANGE_STORAGE": "index of each set among the stored ones; -1 of a black set, which is not stored",
}

# {macro: default}. Tests and benchmarks replace them by `defines` of `assembler.assemble`.
HOOKS = {
    "KERNELS": "1",  # 0: the base alone
    "AT_KERNEL(light, beside, count)": "",  # statements at the sample of a kernel, the k-th of `count`
    # Places for planted errors.
    "SPOILT_TARGET(value)": "value",  # the lobe that is estimated
    "SPOILT_KERNEL(weight)": "weight",  # weight of a kernel
    "SPOILT_BASE(weight)": "weight",  # weight of a base lobe
    "SPOILT_LARGER(at_view, at_light)": "max(at_view, at_light)",  # the albedo that a pump's stage divides by
    "SPOILT_LUMP(value)": "value",  # density of a lump of exponent n
    "SPOILT_STRETCH(value)": "value",  # area on the disk per solid angle of lights, by the scaling projection
    "SPOILT_BELL(weight)": "weight",  # weight of a bell
    "SPOILT_DEVIATION(value)": "value",  # standard deviation of a lump
    "SPOILT_U(u)": "u",  # uniform numbers of a kernel
    "SPOILT_V(v)": "v",
    "FIRST_NUMBER(place, apart)": "hashnoise(place, apart)",  # a hit's first uniform number
    "SECOND_HASH": "11.5",  # offsets of the second and the third number's hash
    "THIRD_HASH": "23.5",
}


def text(macros: dict) -> str:
    """`macros` {name: value} as lines of a header."""
    return "".join(f"#define {name} {value}".rstrip() + "\n" for name, value in macros.items())
