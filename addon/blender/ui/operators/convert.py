"""Conversion of a material to another model, with the same width of its lobe."""
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
        match = materials.convert(material, self.model)
        losses = _losses(match, lost)
        self.report({"WARNING"} if losses else {"INFO"}, ". ".join([_summary(match), *losses]))
        return {"FINISHED"}


def _summary(match):
    """The result of a conversion in one line: the lobe's half-angles, and the parameters that determine them."""
    target = MODELS[match.target]
    values = ", ".join(f"{target.parameter(name).label} {match.parameters[name]:.4g}" for name in target.widths)
    narrow, wide = min(match.half_angles), max(match.half_angles)
    angles = f"{narrow:.3g}°" if wide < 1.001 * narrow else f"{match.half_angles[0]:.3g}° × {match.half_angles[1]:.3g}°"
    return f"{target.label}, half-angle {angles}: {values}".replace("inf°", "none")


def _losses(match, lost):
    """Sentences on the properties that a conversion lost: width, parameters, and the links `lost`."""
    source, target = MODELS[match.source], MODELS[match.target]

    def labels(model, names):
        return ", ".join(model.parameter(name).label for name in names)

    width = " × ".join(f"{angle:.3g}°" for angle in dict.fromkeys(match.wanted))
    return [text for names, text in (
        (match.held, f"{labels(target, match.held)} ends before the width of {source.label}, {width}"),
        (match.dropped, f"{target.label} has no {labels(source, match.dropped)}"),
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
