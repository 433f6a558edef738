"""The values that a node's program was made for, and their comparison with the node's present values."""
import json

from .. import backend as backends
from ..backend import pair_of, text_of
from ..host import row_cache
from . import driven, groups
from .curves import curves
from .driven import driven_among, keep_ranges, path_of
from .groups import model_of
from .replace import replace_node
from .sockets import by_id, values

# Custom property of a group: the values that its program was made for, as JSON; see `key_of`.
BAKED_KEY = "plausible_baked"
# Custom property of a group: its program's largest errors up to 80 degrees, (of the lobe, of the albedo).
ERROR_KEY = "plausible_baked_error"


def key_of(backend, key: str = BAKED_KEY) -> str:
    """The name of a group's custom property for one backend, as a group may hold the programs of several."""
    return key if backend.id == backends.DEFAULT.id else f"{key}_{backend.id}"


def is_stale(node) -> bool:
    """Whether a node's program was made for other values than its sockets have, or for an older state of an image.

    A missing image counts as unchanged, as the program is the only copy of it.
    """
    if groups.backend_of(node).follows_sockets(model_of(node)):
        return False
    *then, stamps = _baked_for(node.node_tree, groups.backend_of(node))
    *now, stamps_now = _from_json(_to_json(node, driven.ranges(node)))
    return then != now or any(stamps.get(name, stamp) != stamp for name, stamp in stamps_now.items() if stamp)


def baked_error(node):
    """Largest errors (of the lobe, of the albedo) of a node's program, see `Backend.error`; None if unknown."""
    return pair_of(node.node_tree.get(key_of(groups.backend_of(node), ERROR_KEY)))


def target(node) -> tuple:
    """({id: value} of the other parameters, {id: (least, most)} of the driven ones): the input of a node's program."""
    ranges = driven.ranges(node)
    return {name: value for name, value in values(node).items() if name not in ranges}, ranges


def bake(node, error: tuple | None = None):
    """Make a node's program anew, for the values of its sockets and over the ranges of the driven parameters.

    `error` is the error of its program, see `baked_error`; None measures it. Raises as `create_material`.
    """
    ranges = driven.ranges(node)
    groups.load(node, values(node), ranges)
    record(node, error, ranges)


def record(node, error: tuple | None = None, ranges: dict | None = None):
    """Record the values and `ranges` that the node's program was made for and its error, and update the fallback.

    Measures the error if `error` is None. Does nothing where the program follows the sockets.
    """
    model, backend = model_of(node), groups.backend_of(node)
    if backend.follows_sockets(model):
        return
    group, ranges = node.node_tree, ranges or {}
    group[key_of(backend)] = _to_json(node, ranges)
    _store_drivers_ranges(node, ranges)
    # The error: from the cache, from the caller, or measured.
    current, what = values(node), key_of(backend, "error")
    error = row_cache.fetch(row_cache.key(model, current, what, ranges),
                            lambda: error or backend.error(model, current, ranges))
    if error is not None:
        group[key_of(backend, ERROR_KEY)] = error
    if backend != backends.FALLBACK:
        update_fallback(node)


def _store_drivers_ranges(node, ranges):
    """Store the ranges of parameters with drivers, whose usual range would change with the value at every frame."""
    paths = {curve.data_path for curve in curves(node.id_data) if curve.driver}
    sockets = by_id(node)
    with_drivers = {name: pair for name, pair in ranges.items() if path_of(sockets[name]) in paths}
    if with_drivers:
        keep_ranges(node.node_tree, with_drivers)


def update_fallback(node):
    """Fit the fallback to a node's values. It stays as it is if the fit fails."""
    try:
        backends.FALLBACK.update(node.node_tree, backends.FALLBACK.program(model_of(node), values(node)))
    except ValueError as error:  # an image that cannot be read
        print(f"Plausible BRDF: {node.name}: {error}")


def take_over(old, before: dict, model, given: dict):
    """Replace the node `old`, whose sockets by parameter id are `before`, by a node of `model`. Returns the new node.

    Its program is made for the values `given`. Where links, drivers or keyframes drive a parameter, baking over ranges
    would take too long here: the program is blank until it is baked. Raises as `Backend.program`.
    """
    backend = backends.of_group(old.node_tree)
    if driven_among(model, backend, before, old.id_data):
        new = groups.add_program(old.id_data, model, backend, backend.blank(model))
    else:
        new = groups.add_node(old.id_data, model, backend, given)
    replace_node(old, before, new)
    return new


def _baked_for(group, backend):
    """(values, ranges, file stamps), by parameter id, of a group's program; (None, {}, {}) if unknown."""
    try:
        return _from_json(text_of(group, key_of(backend)))
    except (TypeError, ValueError):  # the property is missing, or edited by hand
        return None, {}, {}


def _to_json(node, ranges):
    """JSON of [values of parameters that are not driven, file stamps, ranges], each by parameter id."""
    fixed = {name: value for name, value in values(node).items() if name not in ranges}
    stamps = {p.id: p.stamp(fixed[p.id]) for p in model_of(node).parameters if p.kind == "image"}
    return json.dumps([fixed, stamps, ranges])


def _from_json(text):
    """(values, ranges, file stamps) from the text of `_to_json`. Raises TypeError, ValueError for any other text."""
    # Older versions wrote no ranges.
    fixed, stamps, ranges = [*json.loads(text), {}][:3]
    if not isinstance(stamps, dict) or not isinstance(ranges, dict):
        raise ValueError(text)
    return fixed, ranges, stamps
