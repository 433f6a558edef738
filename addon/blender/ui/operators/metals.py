"""The operator and the menu that set a metal's color and optical constants."""
import bpy

from ....library.metals import METALS
from ...material import materials
from .common import OnMaterial, material_of, plausible_node, reporting

_ITEMS = [(name, metal.label, metal.reference, i) for i, (name, metal) in enumerate(METALS.items())]


class PLAUSIBLE_OT_set_metal(OnMaterial, bpy.types.Operator):
    """Set color, edge color, n and k to those of a metal; the choice of Fresnel stays"""

    bl_idname = "plausible.set_metal"
    bl_label = "Set Metal"

    metal: bpy.props.EnumProperty(name="Metal", items=_ITEMS)

    @classmethod
    def description(cls, context, properties):
        return f"Set color, n and k to those of {METALS[properties.metal].label.lower()}; the choice of Fresnel stays"

    @reporting
    def execute(self, context):
        node, model = plausible_node(material_of(context))
        metal = METALS[self.metal]
        values = {"base_color": metal.f0, "f90": metal.f90, "ior": metal.ior, "extinction": metal.extinction}
        materials.set_values(node, {p: values[p.id] for p in model.parameters if p.id in values})
        return {"FINISHED"}


class PLAUSIBLE_MT_metals(bpy.types.Menu):
    """Metals with measured optical constants"""

    bl_idname = "PLAUSIBLE_MT_metals"
    bl_label = "Metals"

    def draw(self, context):
        for name, metal in METALS.items():
            self.layout.operator("plausible.set_metal", text=metal.label).metal = name


CLASSES = (PLAUSIBLE_OT_set_metal, PLAUSIBLE_MT_metals,)
