"""The operator and the menus that apply presets."""
import bpy

from ....library.presets import PRESETS
from ...material import materials
from .. import icons
from .common import OnMaterial, material_of, reporting

_ITEMS = [(name, preset.label, preset.help, i) for i, (name, preset) in enumerate(PRESETS.items())]


class PLAUSIBLE_OT_apply_preset(OnMaterial, bpy.types.Operator):
    """Turn the material into a preset: its model and all of its parameters; what is plugged in stays"""

    bl_idname = "plausible.apply_preset"
    bl_label = "Apply Preset"

    preset: bpy.props.EnumProperty(name="Preset", items=_ITEMS)

    @classmethod
    def description(cls, context, properties):
        return PRESETS[properties.preset].help

    @reporting
    def execute(self, context):
        materials.apply_preset(material_of(context), PRESETS[self.preset])
        return {"FINISHED"}


class PLAUSIBLE_MT_presets(bpy.types.Menu):
    """Materials by name"""

    bl_idname = "PLAUSIBLE_MT_presets"
    bl_label = "Presets"

    def draw(self, context):
        for menu in _GROUP_MENUS:
            self.layout.menu(menu.bl_idname)


class _OfGroup:
    """Base of the menus with the presets of one group, whose name is the label."""

    def draw(self, context):
        for name, preset in PRESETS.items():
            if preset.group == self.bl_label:
                icon = icons.icon_of(name)
                self.layout.operator("plausible.apply_preset", text=preset.label, icon_value=icon).preset = name


def _group_menus():
    """A menu class for each group of presets."""
    groups = dict.fromkeys(preset.group for preset in PRESETS.values())
    return tuple(type(name, (_OfGroup, bpy.types.Menu), {"bl_idname": name, "bl_label": group})
                 for group in groups for name in [f"PLAUSIBLE_MT_presets_{group.lower().replace(' ', '_')}"])


_GROUP_MENUS = _group_menus()


CLASSES = (PLAUSIBLE_OT_apply_preset, PLAUSIBLE_MT_presets, *_GROUP_MENUS,)
