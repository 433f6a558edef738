"""Turning a material into another model whose lobe is as wide."""
import bpy

from ....models import MODELS
from ...material import materials
from .. import icons
from ..properties import MODEL_ITEMS
from .common import OnMaterial, material_of, plausible_node, reporting


class PLAUSIBLE_OT_convert(OnMaterial, bpy.types.Operator):
    """Turn the material into another model whose lobe is as wide, which takes some seconds where the model is baked"""

    bl_idname = "plausible.convert"
    bl_label = "Convert"

    model: bpy.props.EnumProperty(name="Model", items=MODEL_ITEMS)

    @classmethod
    def description(cls, context, properties):
        return f"Turn the material into {MODELS[properties.model].label}, its lobe as wide as now"

    @reporting
    def execute(self, context):
        material = material_of(context)
        lost = materials.unplugged(material, self.model)
        found = materials.convert(material, self.model)
        complaints = _complaints(found, lost)
        self.report({"WARNING"} if complaints else {"INFO"}, ". ".join([_matched(found), *complaints]))
        return {"FINISHED"}


def _matched(found):
    """What a conversion gives, in a line: how wide the lobe is and by which parameters."""
    target = MODELS[found.target]
    values = ", ".join(f"{target.parameter(name).label} {found.parameters[name]:.4g}" for name in target.widths)
    narrow, wide = min(found.half_angles), max(found.half_angles)
    angles = f"{narrow:.3g}°" if wide < 1.001 * narrow else f"{found.half_angles[0]:.3g}° × {found.half_angles[1]:.3g}°"
    return f"{target.label}, half-angle {angles}: {values}".replace("inf°", "none")


def _complaints(found, lost):
    """What a conversion could not keep."""
    source, target = MODELS[found.source], MODELS[found.target]

    def labels(model, names):
        return ", ".join(model.parameter(name).label for name in names)

    wanted = " × ".join(f"{angle:.3g}°" for angle in dict.fromkeys(found.wanted))
    return [text for names, text in (
        (found.held, f"{labels(target, found.held)} ends before the width of {source.label}, {wanted}"),
        (found.dropped, f"{target.label} has no {labels(source, found.dropped)}"),
        (lost, f"Links are lost of {', '.join(lost)}"),
    ) if names]


class PLAUSIBLE_MT_convert(bpy.types.Menu):
    """Turn the material into another model whose lobe is as wide"""

    bl_idname = "PLAUSIBLE_MT_convert"
    bl_label = "Convert to"

    def draw(self, context):
        now = plausible_node(material_of(context))[1]
        for model in MODELS.values():
            if model is not now:
                icon = icons.icon_of(model.id)
                self.layout.operator("plausible.convert", text=model.label, icon_value=icon).model = model.id


CLASSES = (PLAUSIBLE_OT_convert, PLAUSIBLE_MT_convert,)
