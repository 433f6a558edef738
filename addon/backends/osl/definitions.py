"""What the assembler writes in front of a shader besides the shared numbers: macros by model, and hooks.

Each macro that a shader expects and does not define itself is in `constants.SHARED`, `MODEL` or `HOOKS`, or is one of
LEAST_, MOST_ and DEFAULT_ with the id of a parameter.
"""

# macro: what it holds. A model has those that its shader asks for.
MODEL = {
    # The signature, and what is chosen by the declaration.
    "MODEL": "id",
    "MODEL_PARAMETERS": "inputs, of their declared types and defaults",
    "DATA_PARAMETERS": "inputs that are arrays of numbers, or paths of tables",
    "PROJECTION": "SCALING or ORTHOGONAL, of lumps on the disk",
    "HELD_RADII": "1 where a lump is shrunk until it stays on the disk",
    # Albedo tables: by number, or by texture().
    "TABLE_FILE": "defined where tables are read by texture()",
    "AXES_PLAIN": "axes of the table of plain albedos,",
    "AXES_CONTROLLED": "of controlled ones,",
    "AXES_VOLUME": "of volumes,",
    "TABLE_NAME_PLAIN": "and what a message calls them",
    "TABLE_NAME_CONTROLLED": "",
    "TABLE_NAME_VOLUME": "",
    "VOLUME_LAYERS": "radii of the table of volumes",
    # The table of bells.
    "BELLS_ROW": "numbers of a row of the table of bells",
    "STEEP_ROWS": "where rows of steep lumps begin,",
    "STEEP_ROW": "numbers of each,",
    "STEEP_KNOTS": "and where their knots begin",
    # Base lobes of a family.
    "BASE_U": "nodes of the view,",
    "BASE_V": "and of the exponent,",
    "BASE_POWER": "which are even in this power",
    "BASE_FEATURES": "cosines that the gain is read at",
    "BASE_GRAZING": "how far the mean of N.L at grazing lies above N.V, in parts of the lobe's width",
    "BASE_DRAWN": "exponent of the lobe that splats are drawn from, in parts of n",
    "BASE_NEGATIVE_RADIUS": "radius of the widest holes, in parts of the lobe's width",
    "BASE_SETS": "sets of colours of ramps",
    "BASE_STRIDE": "vectors of one gain of one node",
    "BASE_LEVELS": "slots of all sets",
    "BASE_RAMPS": "ramps",
    "BASE_FACETS": "microfacets,",
    "BASE_FACET_ROOM": "and elements of their arrays",
    "BASE_PLAIN": "1 where phong_ramp itself is the lobe",
    # Lobe rows of a baked model.
    "MODEL_LABEL": "what a message calls it",
    "MODEL_MATCHES": "whether the inputs are those that it was baked for",
    "W_VIEWS": "rows of one azimuth",
    "W_AZIMUTHS": "azimuths of views",
    "W_WHOLE": "1 where they go all around",
    "W_RINGS": "rings of cells,",
    "W_AROUND": "and cells around each",
    "W_CHANNELS": "energies of a cell",
    "W_SPIKES": "colours of the mirror from row to row, 0 without a spike",
    "W_RANGES": "driven parameters,",
    "W_SETS": "sets of rows for their steps,",
    "RANGE_PLACES": "where each is among its steps,",
    "RANGE_STEPS": "how many steps it has,",
    "RANGE_STORAGE": "and where each set is stored, -1: nowhere, it is black",
}

# macro: what it is unless `defines` of `source.assemble` say otherwise, as tests and benchmarks do.
HOOKS = {
    "KERNELS": "1",  # 0: the base alone
    "AT_KERNEL(light, beside, count)": "",  # statements where a splat is drawn, of `count` the k-th
    "SPOILT_TARGET(value)": "value",  # planted errors: in the lobe that is estimated,
    "SPOILT_KERNEL(weight)": "weight",  # in what splats weigh,
    "SPOILT_BASE(weight)": "weight",  # in what base lobes weigh,
    "SPOILT_LARGER(at_view, at_light)": "max(at_view, at_light)",  # in which albedo a stage divides by,
    "SPOILT_U(u)": "u",  # in the numbers that splats are drawn by,
    "SPOILT_V(v)": "v",
    "FIRST_NUMBER(place, apart)": "hashnoise(place, apart)",  # in a hit's first number,
    "SECOND_HASH": "11.5",  # and in what its second and third number's hash differ by
    "THIRD_HASH": "23.5",
}


def text(macros: dict) -> str:
    """Macros as lines of a header."""
    return "".join(f"#define {name} {value}".rstrip() + "\n" for name, value in macros.items())
