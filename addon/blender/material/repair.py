"""Nodes of ours that were edited by hand and no longer work: what they lack, and a fresh one in their place."""
from ..backend import MODEL_KEY
from ..host.translation import tr
from . import baked_state, groups, row_jobs
from .sockets import by_id, carried


def complaint(node) -> str:
    """What a node lacks that names one of our models, in a sentence; "" where it is whole or none of ours."""
    tree = getattr(node, "node_tree", None)
    if tree is None or MODEL_KEY not in tree:
        return ""
    model = groups.named_model(tree)
    if model is None:
        return tr("The node is of a model that this version of the extension does not know: {name}",
                   name=tree[MODEL_KEY])
    if lost_shader(node):
        return tr("The node was edited and its shader is gone or damaged")
    held, backend = by_id(node), groups.backend_of(node)
    unfed = backend.unfed(tree, groups.socket_identifiers(tree))
    lost = [tr(p.label) for p in backend.parameters(model) if p.id not in held or p.id in unfed]
    lost += groups.lacking(tree)
    return tr("The node was edited and lacks {names}", names=", ".join(lost)) if lost else ""


def lost_shader(node) -> bool:
    """Whether a node names one of our models and has no program, or none that renders."""
    model = groups.model_of(node)
    return model is not None and groups.backend_of(node).installed(node.node_tree) is None


def can_renew(node) -> bool:
    """Whether a fresh node can take the place of one that is `broken`: its model is known."""
    return groups.named_model(node.node_tree) is not None


def broken(material) -> list:
    """The nodes of a material that have a complaint."""
    tree = material and material.node_tree
    return [node for node in tree.nodes if complaint(node)] if tree else []


def renew(old):
    """Put a fresh node in the place of one that was edited; its values, links and keyframes stay where it has them.

    Raises as `groups.add_node`.
    """
    model, before = groups.named_model(old.node_tree), by_id(old)
    row_jobs.settle(baked_state.take_over(old, before, model, carried(model, before)))
