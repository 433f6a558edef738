"""Notices of problems that keep a material from rendering, with buttons that solve them."""
import bpy

from ...forms.albedo import tables, tabulated
from .. import backend as backends
from ..backend import Cure, Notice
from ..backend.osl import GET_BLENDER
from ..host import table_folder
from ..host.translation import tr
from ..material import groups, repair, upgrade
from ..material.sockets import values

# The oldest supported version of Blender.
OLDEST = (4, 2, 0)


def notices(context, node=None, material=None) -> list:
    """The notices for a material with a Plausible `node` in the context's scene, the gravest first.

    Without a node they cover the obstacles to making such a material, and damaged or outdated nodes of `material`.
    """
    # Without a suitable Blender nothing else matters.
    backend = backends.DEFAULT if node is None else groups.backend_of(node)
    unsupported = _unsupported_blender(backend)
    if unsupported:
        return [unsupported]
    all_notices = [*_edited(material), _tables(node), _older(material)]
    if node is not None:
        scene = context.scene
        all_notices = [_engine(scene), *backend.why_not(scene),
                       *backend.notices(node, groups.model_of(node), values(node)), _newer(node), *all_notices]
    return [notice for notice in all_notices if notice is not None]


def _unsupported_blender(backend):
    """The notice for a Blender that is too old or cannot run the backend, or None."""
    if bpy.app.version < OLDEST:
        return Notice(tr("Blender {version} is too old: this needs 4.2 or later", version=bpy.app.version_string),
                      (GET_BLENDER,))
    return next(iter(backend.why_not()), None)


def _engine(scene):
    """The notice for a scene with another engine than Cycles, or None."""
    if scene.render.engine == "CYCLES":
        return None
    with_cycles = Cure("wm.context_set_enum", "Render with Cycles",
                       {"data_path": "scene.render.engine", "value": "CYCLES"})
    return Notice("Only Cycles renders the model; other engines show a stand-in", (with_cycles,), "INFO")


def _newer(node):
    """The notice for a node from a later version of the extension, or None."""
    if not upgrade.is_newer(node):
        return None
    return Notice(tr("Made by version {version} of the extension: this one is older and may not know all of it",
                      version=upgrade.version_of(node)), icon="INFO")


def _older(material):
    """The notice for outdated nodes, as of an appended material; else the report of the upgrade on loading, or None."""
    tree = material and material.node_tree
    if tree and material.is_editable and any(upgrade.is_outdated(node) for node in tree.nodes):
        return Notice("Made by an earlier version of the extension", (Cure("plausible.upgrade", "Upgrade Materials"),),
                      "INFO")
    return Notice(upgrade.told, icon="INFO") if upgrade.told else None


def _edited(material):
    """Notices for the nodes of a material that edits have damaged."""
    cures = (Cure("plausible.renew", "Renew Node"),)
    return [Notice(repair.complaint(node), cures if repair.can_renew(node) else ()) for node in repair.broken(material)]


def _tables(node):
    """The notice for an unusable albedo table of the node's model, without a node of any model; or None."""
    model = None if node is None else groups.model_of(node)
    text = table_folder.problem(tables.TABLES if model is None else tabulated.tables_of(model))
    models = {} if model is None else {"models": {model.id}}
    return Notice(text, (Cure("plausible.choose_bake", "Bake LUTs", models),)) if text else None
