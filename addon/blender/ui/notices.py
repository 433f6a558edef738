"""What stands between a material and its picture, in words, and the button that mends it."""
import bpy

from ...forms.albedo import tables, tabulated
from .. import backend as backends
from ..backend import Cure, Notice
from ..backend.osl import GET_BLENDER
from ..host import table_folder
from ..host.translation import tr
from ..material import groups, repair, upgrade
from ..material.sockets import values

OLDEST = (4, 2, 0)


def notices(context, node=None, material=None) -> list:
    """The notices for a material in the context's scene with a `node` of ours, the gravest first.

    Without a node there is no such material yet, and only what stands in the way of making one counts.
    """
    missing = _build_lacks_something()
    if missing:
        return [missing]
    found = [*_edited(material), _tables(node), _older(material)]
    if node is not None:
        scene, backend = context.scene, groups.backend_of(node)
        found = [_engine(scene), *backend.why_not(scene), *backend.notices(node, groups.model_of(node), values(node)),
                 _newer(node), *found]
    return [notice for notice in found if notice is not None]


def _build_lacks_something():
    if bpy.app.version < OLDEST:
        return Notice(tr("Blender {version} is too old: this needs 4.2 or later", version=bpy.app.version_string),
                      (GET_BLENDER,))
    return next(iter(backends.DEFAULT.why_not()), None)


def _engine(scene):
    if scene.render.engine == "CYCLES":
        return None
    with_cycles = Cure("wm.context_set_enum", "Render with Cycles",
                       {"data_path": "scene.render.engine", "value": "CYCLES"})
    return Notice("Only Cycles renders the model; other engines show a stand-in", (with_cycles,), "INFO")


def _newer(node):
    if not upgrade.is_newer(node):
        return None
    return Notice(tr("Made by version {version} of the extension: this one is older and may not know all of it",
                      version=upgrade.version_of(node)), icon="INFO")


def _older(material):
    """Of the material shown, as one that was appended, else what became of those that the file brought."""
    tree = material and material.node_tree
    if tree and material.is_editable and any(upgrade.is_outdated(node) for node in tree.nodes):
        return Notice("Made by an earlier version of the extension", (Cure("plausible.upgrade", "Upgrade Materials"),),
                      "INFO")
    return Notice(upgrade.told, icon="INFO") if upgrade.told else None


def _edited(material):
    """That nodes of a material were edited so that they do not work."""
    cures = (Cure("plausible.renew", "Renew Node"),)
    return [Notice(repair.complaint(node), cures if repair.can_renew(node) else ()) for node in repair.broken(material)]


def _tables(node):
    model = None if node is None else groups.model_of(node)
    text = table_folder.problem(tables.TABLES if model is None else tabulated.tables_of(model))
    models = {} if model is None else {"models": {model.id}}
    return Notice(text, (Cure("plausible.choose_bake", "Bake LUTs", models),)) if text else None
