"""Plausible nodes that no longer work after edits by hand: their defects, and their replacement."""
from .. import backend as backends
from ..backend import MODEL_KEY
from ..host.translation import tr
from . import baked_state, groups, row_jobs
from .sockets import by_id, carried


def complaint(node) -> str:
    """A sentence on the defects of a Plausible node; "" for intact nodes and for other nodes."""
    tree = getattr(node, "node_tree", None)
    if tree is None or MODEL_KEY not in tree:
        return ""
    model = groups.named_model(tree)
    if model is None:
        return tr("The node is of a model that this version of the extension does not know: {name}",
                  name=tree[MODEL_KEY])
    if backends.unknown(tree):
        return tr("The node is rendered by a backend that this version of the extension does not know: {name}",
                  name=backends.unknown(tree))
    if lost_shader(node):
        return tr("The node was edited and its shader is gone or damaged")
    # Sockets and outputs that are missing or no longer linked inside.
    sockets, backend = by_id(node), groups.backend_of(node)
    unfed = backend.unfed(tree, groups.socket_identifiers(tree))
    missing = [tr(p.label) for p in backend.parameters(model) if p.id not in sockets or p.id in unfed]
    missing += groups.lacking(tree)
    return tr("The node was edited and lacks {names}", names=", ".join(missing)) if missing else ""


def lost_shader(node) -> bool:
    """Whether the program of a node of a known model is missing or damaged."""
    model = groups.model_of(node)
    group = node.node_tree if model is not None else None
    return group is not None and not backends.unknown(group) and groups.backend_of(node).installed(group) is None


def can_renew(node) -> bool:
    """Whether a new node can replace a `broken` one: its model has to be known."""
    return groups.named_model(node.node_tree) is not None


def broken(material) -> list:
    """The nodes of a material with a `complaint`."""
    tree = material and material.node_tree
    return [node for node in tree.nodes if complaint(node)] if tree else []


def renew(old):
    """Replace an edited node by a new one. Values, links and keyframes of the sockets that it still has are taken over.

    Raises as `groups.add_node`.
    """
    model, before = groups.named_model(old.node_tree), by_id(old)
    row_jobs.settle(baked_state.take_over(old, before, model, carried(model, before)))
