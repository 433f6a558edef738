"""What stands between a material and its picture, in words, and the button that mends it."""
from dataclasses import dataclass, field

import bpy

from ..brdf import tables
from . import groups, luts, nodes, osl, renew, stand_in, switches, upgrade
from .words import say

OLDEST = (4, 2, 0)


@dataclass(frozen=True)
class Cure:
    """A button: an operator's name, what stands on it, and the operator's settings."""

    operator: str
    label: str = ""
    settings: dict = field(default_factory=dict)


class Notice:
    """A message for the panel, with the `cures` that mend what it tells, any of them, and an icon."""

    def __init__(self, text: str, *cures: Cure, icon: str = "ERROR"):
        self.text, self.cures, self.icon = text, cures, icon


_GET_BLENDER = Cure("wm.url_open", "Get Blender", {"url": "https://www.blender.org/download/"})


def notices(context, node=None, material=None) -> list:
    """The notices for a material in the context's scene with a `node` of ours, the gravest first.

    Without a node there is no such material yet, and only what stands in the way of making one counts.
    """
    missing = _build_lacks_something()
    if missing:
        return [missing]
    scene = context.scene
    model = None if node is None else nodes.model_of(node)
    found = [*_edited(material), _tables(model), _older(material)]
    if model is not None:
        stands = [_native(node)] if switches.is_native(node) else [_osl_off(scene), _wrong_device(scene), _beyond(node),
                                                                     _files(node)]
        found = [_engine(scene), *stands, _newer(node), *found]
    return [notice for notice in found if notice is not None]


_NATIVE = Cure("plausible.switch_native", "Native Approximation")


def _build_lacks_something():
    if bpy.app.version < OLDEST:
        return Notice(say(
            "Blender {version} is too old: this needs 4.2 or later", version=bpy.app.version_string), _GET_BLENDER)
    reason = osl.unavailable()
    return reason and Notice(reason, _GET_BLENDER)


def _engine(scene):
    if scene.render.engine == "CYCLES":
        return None
    return Notice("Only Cycles renders the model; other engines show a stand-in", Cure(
        "wm.context_set_enum", "Render with Cycles", {"data_path": "scene.render.engine", "value": "CYCLES"}),
        icon="INFO")


def _osl_off(scene):
    if scene.render.engine != "CYCLES" or scene.cycles.shading_system:
        return None
    return Notice("Open Shading Language is off in this scene: Plausible materials render black",
                  Cure("plausible.use_osl", "Switch on OSL"), _NATIVE)


def osl_is_on(scene) -> bool:
    """Whether the scene renders in Cycles with Open Shading Language."""
    return scene.render.engine == "CYCLES" and scene.cycles.shading_system


def _wrong_device(scene):
    if scene.render.engine != "CYCLES" or scene.cycles.device != "GPU":
        return None
    # Cycles keeps 1 KB a hit for OSL's closures there, and does not look whether they fit.
    text = ("On the GPU these materials ask for more room than Cycles has: render on the CPU, or what Cycles ships in "
            "place of the model" if osl.supports_osl(scene) else
            "OSL on GPU needs OptiX, and these materials more room than Cycles has there: render on the CPU, or what "
            "Cycles ships in place of the model")
    return Notice(text, Cure(
        "wm.context_set_enum", "Render on CPU", {"data_path": "scene.cycles.device", "value": "CPU"}), _NATIVE)


def _native(node):
    """That a material shows the stand-in."""
    try:
        lobe, albedo = stand_in.error(nodes.model_of(node), nodes.values(node))
    except ValueError:  # an image that cannot be read
        text = say("Cycles renders the native approximation in place of the model")
    else:
        text = say("Cycles renders the native approximation in place of the model. Its lobe differs by {lobe:.2g} %, "
                   "its albedo by {albedo:.2g} %", lobe=lobe, albedo=albedo)
    return Notice(text, Cure("plausible.switch_native", "Render the Model"), icon="INFO")


def _newer(node):
    if not upgrade.is_newer(node):
        return None
    return Notice(say("Made by version {version} of the extension: this one is older and may not know all of it",
                      version=upgrade.version_of(node)), icon="INFO")


def _older(material):
    """Of the material shown, as one that was appended, else what became of those that the file brought."""
    tree = material and material.node_tree
    if tree and material.is_editable and any(upgrade.is_outdated(node) for node in tree.nodes):
        return Notice("Made by an earlier version of the extension", Cure("plausible.upgrade", "Upgrade Materials"),
                      icon="INFO")
    return Notice(upgrade.told, icon="INFO") if upgrade.told else None


def _edited(material):
    """That nodes of a material were edited so that they do not work."""
    cures = [Cure("plausible.renew", "Renew Node")]
    return [Notice(renew.complaint(node), *(cures if renew.can_renew(node) else ())) for node in renew.broken(material)]


def _tables(model):
    text = luts.problem(tables.TABLES if model is None else model.tables)
    models = {} if model is None else {"models": {model.id}}
    return text and Notice(text, Cure("plausible.choose_bake", "Bake LUTs", models))


def _files(node):
    """That a table which a node reads from its file, at render time, cannot be read."""
    wrong = [luts.problem_of(name, path) for name, path in groups.table_files(node).items()]
    return next((Notice(text) for text in wrong if text), None)


def _beyond(node):
    """The notice for a material whose exponent is not one that the tables compiled into it are baked for, or None."""
    model, spans = groups.model_of(node), groups.spans_of(node)
    for name, exponent in model.readings(model.resolve(nodes.values(node))):
        span = spans.get(name)
        if span is None or tables.covers(span, exponent):
            continue
        text = say("Exponent {exponent:.6g} is beyond the material's tables, which are for {low:g} to {high:g}: it "
                   "renders striped", exponent=exponent, low=span[0], high=span[1])
        if luts.problem([name]) is None and tables.covers(tables.in_use(name).span, exponent):
            return Notice(text, Cure("plausible.update_materials", "Update Materials"))
        return Notice(text, Cure("plausible.choose_bake", "Bake LUTs", {"models": {model.id}}))
    return None
