"""Materials of an older version of the extension, brought up to this one: on loading a file, or by a button.

Before 0.2 a material held its Script node itself; since then it holds a group. What was linked from another file stays
as it is: it carries all it needs, and renders as it did.
"""
import bpy

from ...version import VERSION, parts
from .. import backend as backends
from ..backend import BSDF, STAND_IN, text_of
from ..backend.osl import SCRIPT
from ..host.translation import tr
from . import baked_state, groups
from .groups import VERSION_KEY, model_of, named_model, trees
from .replace import replace_node
from .sockets import by_id, fitting

_MOVED_KEY = "plausible_moved"  # of a node of 0.2: where its BSDF was plugged in before the stand-in took its place
_OLD_STAND_IN = "Stand-in for EEVEE"  # the Principled node of materials before 0.2
told = ""  # what the last upgrade did, for the panel; "" where there was nothing to do


def version_of(node) -> str:
    """The version of the extension that made a node of ours."""
    return text_of(node.node_tree, VERSION_KEY) if node.bl_idname == "ShaderNodeGroup" else "0.1.0"


def is_newer(node) -> bool:
    """Whether a node was made by a later version than this."""
    return parts(version_of(node)) > parts(VERSION)


def outdated() -> list:
    """Nodes of an older version in what this file can edit."""
    return [node for tree in trees() for node in tree.nodes if is_outdated(node)]


def is_outdated(node) -> bool:
    """Whether a node was made by an older version of the extension."""
    if node.bl_idname == SCRIPT:
        return named_model(node) is not None
    return model_of(node) is not None and parts(version_of(node)) < parts(VERSION)


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
        words.append(tr("Upgraded to {version}: {names}. The file on disk is as it was until you save",
                         version=VERSION, names=", ".join(sorted(set(done)))))
    if failed:
        words.append(tr("Not upgraded: {names}", names="; ".join(failed)))
    return ". ".join(words)


def _owner(tree):
    """The name of the material that a node tree belongs to, or its own."""
    return next((m.name for m in bpy.data.materials if m.node_tree == tree), tree.name)


def upgrade(old):
    """Put a node of this version in the place of an older one; values, links and keyframes stay. Raises as `add_node`.

    A baked model keeps its shader with the weights that it had, as baking takes seconds: the panel bakes them anew.
    """
    tree = old.id_data
    is_script = old.bl_idname == SCRIPT
    held = old if is_script else old.node_tree
    model, backend = named_model(held), backends.of_group(held)
    before = fitting(model, {s.identifier: s for s in old.inputs}) if is_script else by_id(old)
    moved = old.get(_MOVED_KEY)
    if backend.follows_sockets(model):
        new = groups.add_node(tree, model, backend)
    else:
        program = _program_of(old, backend, model)
        new = groups.add_program(tree, model, backend, program)
        for key in (baked_state.key_of(backend), baked_state.ERROR_KEY):
            if key in held:
                new.node_tree[key] = held[key]
    replace_node(old, before, new)
    if not backend.follows_sockets(model):
        baked_state.update_fallback(new)
    _replace_stand_in(tree, new)
    if moved is not None:
        _take_back(new, moved)


def _program_of(old, backend, model):
    """The program of an older node of a model that is baked; a Script node before groups has it itself."""
    if old.bl_idname == SCRIPT:
        return backends.Program(backend.id, model.id, old.bytecode)
    return backend.installed(old.node_tree) or backend.blank(model)


def _take_back(node, moved):
    """A node of 0.2 whose stand-in was plugged in where its BSDF was: the fallback renders it from now on."""
    try:
        places = [tuple(place) for place in moved]
    except TypeError:  # written by hand
        places = []
    for link in list(node.outputs[STAND_IN].links):
        if (link.to_node.name, link.to_socket.identifier) in places:
            node.id_data.links.new(node.outputs[BSDF], link.to_socket)
    groups.switch_backend(node, backends.FALLBACK)
    baked_state.record(node)


def _replace_stand_in(tree, new):
    """Where a material before 0.2 has the Principled node that stood in, untouched by hand, the group's takes over."""
    old = tree.nodes.get(_OLD_STAND_IN)
    if old is None or any(socket.is_linked for socket in old.inputs):
        return
    for link in list(old.outputs[0].links):
        tree.links.new(new.outputs[STAND_IN], link.to_socket)
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
