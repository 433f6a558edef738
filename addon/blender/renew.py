"""Nodes of ours that were edited by hand and no longer work: what they lack, and a fresh one in their place."""
import bpy

from . import groups, nodes, rebake
from .operators import material_of, osl_works, reporting
from .words import say


def complaint(node) -> str:
    """What a node lacks that names one of our models, in a sentence; "" where it is whole or none of ours."""
    tree = getattr(node, "node_tree", None)
    if tree is None or groups.MODEL_KEY not in tree:
        return ""
    model = groups.named_model(tree)
    if model is None:
        return say("The node is of a model that this version of the extension does not know: {name}",
                   name=tree[groups.MODEL_KEY])
    if lost_shader(node):
        return say("The node was edited and its shader is gone or damaged")
    held = groups.sockets(node)
    lost = [say(p.label) for p in model.parameters if p.id not in held] + groups.lacking(tree)
    return say("The node was edited and lacks {names}", names=", ".join(lost)) if lost else ""


def lost_shader(node) -> bool:
    """Whether a node names one of our models and has no shader, or none that Cycles can read."""
    tree = getattr(node, "node_tree", None)
    named = tree is not None and groups.named_model(tree) is not None
    return named and (groups.model_of(node) is None or not groups.has_bytecode(node))


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
    model = groups.named_model(old.node_tree)
    before = groups.sockets(old) if groups.model_of(old) else _by_label(old, model)
    rebake.settle(nodes.take_over(old, before, model, nodes.carried(model, before)))


def _by_label(node, model):
    """The sockets of a node whose Script node is gone: those that are called as parameters are."""
    labels = {p.label: p.id for p in model.parameters}
    return groups.fitting(model, {labels[s.name]: s for s in node.inputs if s.name in labels})


class PLAUSIBLE_OT_renew(bpy.types.Operator):
    """Put a fresh node in the place of one that was edited and no longer works; values, links and keyframes stay"""

    bl_idname = "plausible.renew"
    bl_label = "Renew Node"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        material = material_of(context)
        return (material is not None and material.is_editable and any(map(can_renew, broken(material)))
                and osl_works(cls))

    @reporting
    def execute(self, context):
        for node in broken(material_of(context)):
            if can_renew(node):
                renew(node)
        return {"FINISHED"}


@bpy.app.handlers.persistent
def on_load(*_):
    """Of what a file brings: where bytecode is announced and there is none, Blender would end when it renders."""
    for tree in bpy.data.node_groups:
        for script in tree.nodes if groups.named_model(tree) and tree.is_editable else ():
            if script.bl_idname == "ShaderNodeScript" and script.bytecode_hash and not script.bytecode:
                script.bytecode_hash = ""


def start():
    """Look at every file that is loaded from now on."""
    bpy.app.handlers.load_post.append(on_load)


def stop():
    """Look no more."""
    if on_load in bpy.app.handlers.load_post:
        bpy.app.handlers.load_post.remove(on_load)


CLASSES = (PLAUSIBLE_OT_renew,)
