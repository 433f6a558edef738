"""Upgrades of materials from older versions of the extension: on loading a file, or by a button.

Before 0.2 a material's tree contained the Script node itself; since then it contains a group. Materials linked from
another file stay as they are: they are self-contained, and render as before.
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

# Custom property of a node of 0.2: the sockets (node, identifier) that its BSDF fed before the stand-in replaced it.
_MOVED_KEY = "plausible_moved"
# Name of the Principled node of materials before 0.2.
_OLD_STAND_IN = "Stand-in for EEVEE"
# The report of the last upgrade on loading, for the panel; "" where nothing was outdated.
told = ""


def version_of(node) -> str:
    """The version of the extension that made a Plausible node. Nodes before 0.2 store none: "0.1.0" stands for all."""
    return text_of(node.node_tree, VERSION_KEY) if node.bl_idname == "ShaderNodeGroup" else "0.1.0"


def is_newer(node) -> bool:
    """Whether a later version of the extension made a node."""
    return parts(version_of(node)) > parts(VERSION)


def outdated() -> list:
    """The nodes from older versions in the editable node trees of this file."""
    return [node for tree in trees() for node in tree.nodes if is_outdated(node)]


def is_outdated(node) -> bool:
    """Whether an older version of the extension made a node."""
    if node.bl_idname == SCRIPT:
        return named_model(node) is not None
    return model_of(node) is not None and parts(version_of(node)) < parts(VERSION)


def upgrade_all() -> str:
    """Upgrade all outdated nodes. Returns a report in one or two sentences, "" where no node is outdated.

    A node whose upgrade fails, as for a missing albedo table, stays as it is; the report names the reason.
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
    sentences = []
    if done:
        sentences.append(tr("Upgraded to {version}: {names}. The file on disk is as it was until you save",
                            version=VERSION, names=", ".join(sorted(set(done)))))
    if failed:
        sentences.append(tr("Not upgraded: {names}", names="; ".join(failed)))
    return ". ".join(sentences)


def _owner(tree):
    """The name of the material with a node tree, or the tree's own name where it is a group."""
    return next((m.name for m in bpy.data.materials if m.node_tree == tree), tree.name)


def upgrade(old):
    """Replace an older node by one of this version. Values, links and keyframes stay. Raises as `groups.add_node`.

    A baked model keeps its shader with the old lobe rows, as baking takes seconds; the panel offers a new bake.
    """
    # The old node's model, backend and sockets.
    tree = old.id_data
    is_script = old.bl_idname == SCRIPT
    storage = old if is_script else old.node_tree  # has the custom properties
    model, backend = named_model(storage), backends.of_group(storage)
    before = fitting(model, {s.identifier: s for s in old.inputs}) if is_script else by_id(old)
    moved = old.get(_MOVED_KEY)
    # The new node. A baked program is taken over, with the record of its values and errors.
    if backend.follows_sockets(model):
        new = groups.add_node(tree, model, backend)
    else:
        program = _program_of(old, backend, model)
        new = groups.add_program(tree, model, backend, program)
        for key in (baked_state.key_of(backend), baked_state.ERROR_KEY):
            if key in storage:
                new.node_tree[key] = storage[key]
    # Links, keyframes, and the fallback.
    replace_node(old, before, new)
    if not backend.follows_sockets(model):
        baked_state.update_fallback(new)
    _replace_stand_in(tree, new)
    if moved is not None:
        _take_back(new, moved)


def _program_of(old, backend, model):
    """The program of an older node of a baked model; before groups the Script node itself stored the bytecode."""
    if old.bl_idname == SCRIPT:
        return backends.Program(backend.id, model.id, old.bytecode)
    return backend.installed(old.node_tree) or backend.blank(model)


def _take_back(node, moved):
    """Let the fallback render a node of 0.2 whose stand-in had replaced its BSDF, and link its BSDF again.

    `moved` is the list of (node name, socket identifier) that the BSDF fed.
    """
    try:
        targets = [tuple(target) for target in moved]
    except TypeError:  # edited by hand
        targets = []
    for link in list(node.outputs[STAND_IN].links):
        if (link.to_node.name, link.to_socket.identifier) in targets:
            node.id_data.links.new(node.outputs[BSDF], link.to_socket)
    groups.switch_backend(node, backends.FALLBACK)
    baked_state.record(node)


def _replace_stand_in(tree, new):
    """Replace the Principled node of a material before 0.2 by the group's stand-in, unless a user linked its inputs."""
    old = tree.nodes.get(_OLD_STAND_IN)
    if old is None or any(socket.is_linked for socket in old.inputs):
        return
    for link in list(old.outputs[0].links):
        tree.links.new(new.outputs[STAND_IN], link.to_socket)
    tree.nodes.remove(old)


@bpy.app.handlers.persistent
def on_load(*_):
    """Upgrade the nodes of a loaded file, and print the report."""
    global told
    told = upgrade_all()
    if told:
        print(f"Plausible BRDF: {told}")


def start():
    """Upgrade every file on loading, see `on_load`."""
    bpy.app.handlers.load_post.append(on_load)


def stop():
    """Stop upgrading files."""
    if on_load in bpy.app.handlers.load_post:
        bpy.app.handlers.load_post.remove(on_load)
