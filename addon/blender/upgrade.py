"""Materials of an older version of the extension, brought up to this one: on loading a file, or by a button.

Before 0.2 a material held its Script node itself; since then it holds a group. What was linked from another file stays
as it is: it carries all it needs, and renders as it did.
"""
import bpy

from ..version import VERSION, parts
from . import groups, nodes
from .groups import VERSION_KEY
from .replace import replace_node
from .words import say

_OLD_STAND_IN = "Stand-in for EEVEE"  # the Principled node of materials before 0.2
told = ""  # what the last upgrade did, for the panel; "" where there was nothing to do


def version_of(node) -> str:
    """The version of the extension that made a node of ours."""
    return groups.text_of(node.node_tree, VERSION_KEY) if node.bl_idname == "ShaderNodeGroup" else "0.1.0"


def is_newer(node) -> bool:
    """Whether a node was made by a later version than this."""
    return parts(version_of(node)) > parts(VERSION)


def outdated() -> list:
    """Nodes of an older version in what this file can edit."""
    return [node for tree in nodes.trees() for node in tree.nodes if is_outdated(node)]


def is_outdated(node) -> bool:
    """Whether a node was made by an older version of the extension."""
    if node.bl_idname == "ShaderNodeScript":
        return groups.named_model(node) is not None
    return groups.model_of(node) is not None and parts(version_of(node)) < parts(VERSION)


def upgrade_all() -> str:
    """Upgrade every node that is outdated; says in a sentence what was done, "" where there was nothing.

    One that cannot be upgraded, as for a table that is missing, stays as it was, and the sentence says why.
    """
    done, failed = [], []
    for node in outdated():
        owner = _owner(node.id_data)
        try:
            upgrade(node)
        except (RuntimeError, ValueError, OSError) as error:
            failed.append(f"{owner}: {error}")
        else:
            done.append(owner)
    words = []
    if done:
        words.append(say("Upgraded to {version}: {names}. The file on disk is as it was until you save",
                         version=VERSION, names=", ".join(sorted(set(done)))))
    if failed:
        words.append(say("Not upgraded: {names}", names="; ".join(failed)))
    return ". ".join(words)


def _owner(tree):
    """The name of the material that a node tree belongs to, or its own."""
    return next((m.name for m in bpy.data.materials if m.node_tree == tree), tree.name)


def upgrade(old):
    """Put a node of this version in the place of an older one; values, links and keyframes stay. Raises as `add_node`.

    A baked model keeps its shader with the weights that it had, as baking takes seconds: the panel bakes them anew.
    """
    tree = old.id_data
    is_script = old.bl_idname == "ShaderNodeScript"
    held = old if is_script else old.node_tree
    model, lut = groups.named_model(held), groups.lut_of(held)
    before = groups.fitting(model, {s.identifier: s for s in old.inputs}) if is_script else groups.sockets(old)
    if model.baked:
        script = old if is_script else groups.script_of(old)
        new = groups.add_compiled(tree, model, script.bytecode, lut)
        for key in (nodes.BAKED_KEY, nodes.ERROR_KEY):
            if key in held:
                new.node_tree[key] = held[key]
    else:
        new = groups.add_node(tree, model, lut)
    replace_node(old, before, new)
    if model.baked:
        nodes.show(new)
    _replace_stand_in(tree, new)


def _replace_stand_in(tree, new):
    """Where a material before 0.2 has the Principled node that stood in, untouched by hand, the group's takes over."""
    old = tree.nodes.get(_OLD_STAND_IN)
    if old is None or any(socket.is_linked for socket in old.inputs):
        return
    for link in list(old.outputs[0].links):
        tree.links.new(new.outputs[groups.STAND_IN], link.to_socket)
    tree.nodes.remove(old)


@bpy.app.handlers.persistent
def on_load(*_):
    """Upgrade what a file brings that was just loaded, and say so."""
    global told
    told = upgrade_all()
    if told:
        print(f"Plausible BRDF: {told}")


def start():
    """Upgrade every file that is loaded from now on."""
    bpy.app.handlers.load_post.append(on_load)


def stop():
    """Leave files as they are again."""
    if on_load in bpy.app.handlers.load_post:
        bpy.app.handlers.load_post.remove(on_load)
