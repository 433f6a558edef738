"""The values that a node's program was made for, and whether the node still holds them."""
import json

from ...forms.rows import error as rows_error
from .. import backend as backends
from ..backend import pair_of, text_of
from ..host import row_cache
from . import driven, groups
from .curves import curves
from .driven import driven_among, keep_ranges, path_of
from .groups import model_of
from .replace import replace_node
from .sockets import by_id, values

BAKED_KEY = "plausible_baked"  # of a group: the values that its OSL program was made for, as JSON; see `key_of`
ERROR_KEY = "plausible_baked_error"  # of its rows: largest errors of the lobe and of the albedo up to 80 degrees


def key_of(backend) -> str:
    """The custom property of a group for the values that the program of a backend was made for."""
    return BAKED_KEY if backend == backends.DEFAULT else f"{BAKED_KEY}_{backend.id}"


def is_stale(node) -> bool:
    """Whether a node's program was made for other values than its sockets hold, or for an image that changed since.

    An image that is gone has not changed: the program is all that is left of it.
    """
    if groups.backend_of(node).follows_sockets(model_of(node)):
        return False
    *then, files = _baked_for(node.node_tree, groups.backend_of(node))
    *now, files_now = _read_note(_note(node, driven.ranges(node)))
    return then != now or any(files.get(name, stamp) != stamp for name, stamp in files_now.items() if stamp)


def baked_error(node):
    """Largest errors (of the lobe, of the albedo) of a node's rows up to 80 degrees; None where none are known."""
    return pair_of(node.node_tree.get(ERROR_KEY))


def target(node) -> tuple:
    """(values of parameters that are not driven, ranges of the driven): what a node's program ought to be made for."""
    ranges = driven.ranges(node)
    return {name: value for name, value in values(node).items() if name not in ranges}, ranges


def bake(node, error: tuple | None = None):
    """Make a node's program anew for the values of its sockets, and over ranges of the driven ones.

    `error` is that of its rows if it is known. Raises as `create_material`.
    """
    ranges = driven.ranges(node)
    groups.load(node, values(node), ranges)
    record(node, error, ranges)


def record(node, error: tuple | None = None, ranges: dict | None = None):
    """Record the values that a node's program was made for, with its `ranges`, and bring the fallback up to date.

    The rows' error is measured where `error` does not give it. Nothing is done where the program follows the sockets.
    """
    model, backend = model_of(node), groups.backend_of(node)
    if backend.follows_sockets(model):
        return
    group, ranges = node.node_tree, ranges or {}
    group[key_of(backend)] = _note(node, ranges)
    _keep_drivers_ranges(node, ranges)
    if backend == backends.FALLBACK:
        return
    given = values(node)
    group[ERROR_KEY] = row_cache.fetch(row_cache.key(model, given, "error", ranges),
                                   lambda: error or rows_error.largest(model, given, ranges))
    update_fallback(node)


def _keep_drivers_ranges(node, ranges):
    """A driver's socket has another value at every frame: the range about the first one stays."""
    paths = {curve.data_path for curve in curves(node.id_data) if curve.driver}
    held = by_id(node)
    kept = {name: each for name, each in ranges.items() if path_of(held[name]) in paths}
    if kept:
        keep_ranges(node.node_tree, kept)


def update_fallback(node):
    """Fit the fallback to a node's values; where it cannot be fitted it stays as it was."""
    try:
        backends.FALLBACK.update(node.node_tree, backends.FALLBACK.program(model_of(node), values(node)))
    except ValueError as error:  # an image that cannot be read
        print(f"Plausible BRDF: {node.name}: {error}")


def take_over(old, before: dict, model, given: dict):
    """Put a node of `model` in the place of `old`, whose sockets by parameter id are `before`; returns it.

    Its program is made for the values `given`; where something goes on to drive it, which takes ranges and longer, it
    is blank until it is baked. Raises as `Backend.program`.
    """
    backend = backends.of_group(old.node_tree)
    if driven_among(model, backend, before, old.id_data):
        new = groups.add_program(old.id_data, model, backend, backend.blank(model))
    else:
        new = groups.add_node(old.id_data, model, backend, given)
    replace_node(old, before, new)
    return new


def _baked_for(group, backend):
    """(values, ranges, stamps of files by parameter) that a group's program was made for; (None, {}, {}) if unknown."""
    try:
        return _read_note(text_of(group, key_of(backend)))
    except (TypeError, ValueError):  # nothing is written there, or by hand
        return None, {}, {}


def _note(node, ranges):
    """A JSON text of values that are not driven, of stamps of files, and of ranges."""
    given = {name: value for name, value in values(node).items() if name not in ranges}
    stamps = {p.id: p.stamp(given[p.id]) for p in model_of(node).parameters if p.kind == "image"}
    return json.dumps([given, stamps, ranges])


def _read_note(text):
    """(values, ranges, stamps) of `_note`; files of older versions know no ranges. Raises TypeError, ValueError."""
    given, stamps, ranges = [*json.loads(text), {}][:3]
    if not isinstance(stamps, dict) or not isinstance(ranges, dict):
        raise ValueError(text)
    return given, ranges, stamps
