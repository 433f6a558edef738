"""Operators: new materials, metals, and switching OSL on."""
import functools

import bpy

from ..brdf import MODELS
from ..brdf.metals import METALS
from ..brdf.presets import PRESETS
from . import icons, materials, nodes, osl, rebake, settings, upgrade
from .properties import MODEL_ITEMS

_PRESET_ITEMS = [(name, preset.label, preset.help, i) for i, (name, preset) in enumerate(PRESETS.items())]
_METAL_ITEMS = [(name, metal.label, metal.reference, i) for i, (name, metal) in enumerate(METALS.items())]


def reporting(execute):
    """An operator's `execute` that reports what a user or a file can get wrong, and is then cancelled."""
    @functools.wraps(execute)
    def reported(self, context):
        try:
            return execute(self, context)
        except (RuntimeError, ValueError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    return reported


def material_of(context):
    """The material that a material tab or shader editor shows; None when it shows none."""
    space = context.space_data
    if space is not None and space.type == "NODE_EDITOR":
        return space.id if isinstance(space.id, bpy.types.Material) else None
    return getattr(context, "material", None)


def plausible_node(material):
    """(node, model) of a material made here; (None, None) for any other."""
    node = nodes.find_node(material)
    model = nodes.model_of(node) if node else None
    return (node, model) if model else (None, None)


def osl_works(cls):
    """Whether this Blender runs OSL, for an operator's poll; where not, the button tells why."""
    reason = osl.unavailable()
    if reason:
        cls.poll_message_set(reason)
    return not reason


class PLAUSIBLE_OT_new_material(bpy.types.Operator):
    """Give the active object a new Plausible BRDF material, and switch on Open Shading Language in this scene"""

    bl_idname = "plausible.new_material"
    bl_label = "New Plausible Material"
    bl_options = {"REGISTER", "UNDO"}

    model: bpy.props.EnumProperty(name="Model", items=MODEL_ITEMS, default="pumped_phong")

    @classmethod
    def poll(cls, context):
        thing = context.object
        if thing is None or not hasattr(thing.data, "materials"):
            cls.poll_message_set("The active object cannot have materials")
            return False
        if not (thing.is_editable and thing.data.is_editable):
            cls.poll_message_set("The active object is linked from another file")
            return False
        return osl_works(cls)

    @reporting
    def execute(self, context):
        material = materials.create_material(self.model, **settings.for_new(MODELS[self.model]))
        _put_on(context.object, material)
        if materials.use_osl(context.scene):
            self.report({"INFO"}, f"{material.name}: Open Shading Language is now on for this scene")
        return {"FINISHED"}


def _put_on(thing, material):
    """Put the material into the object's active slot, or into a first slot where it has none."""
    if not thing.material_slots:
        thing.data.materials.append(material)
    else:
        thing.material_slots[thing.active_material_index].material = material


class PLAUSIBLE_OT_use_osl(bpy.types.Operator):
    """Switch on Open Shading Language in this scene; without it Cycles does not run the materials' shaders"""

    bl_idname = "plausible.use_osl"
    bl_label = "Switch on OSL"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.scene is not None and osl_works(cls)

    def execute(self, context):
        materials.use_osl(context.scene)
        return {"FINISHED"}


class OnMaterial:
    """An operator that changes the material shown, and can be undone."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        material = material_of(context)
        return material is not None and material.is_editable and plausible_node(material)[1] is not None


class PLAUSIBLE_OT_set_metal(OnMaterial, bpy.types.Operator):
    """Set colour, edge colour, n and k to those of a metal; the choice of Fresnel stays"""

    bl_idname = "plausible.set_metal"
    bl_label = "Set Metal"

    metal: bpy.props.EnumProperty(name="Metal", items=_METAL_ITEMS)

    @classmethod
    def description(cls, context, properties):
        return f"Set colour, n and k to those of {METALS[properties.metal].label.lower()}; the choice of Fresnel stays"

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


class PLAUSIBLE_OT_apply_preset(OnMaterial, bpy.types.Operator):
    """Turn the material into a preset: its model and all of its parameters; what is plugged in stays"""

    bl_idname = "plausible.apply_preset"
    bl_label = "Apply Preset"

    preset: bpy.props.EnumProperty(name="Preset", items=_PRESET_ITEMS)

    @classmethod
    def description(cls, context, properties):
        return PRESETS[properties.preset].help

    @reporting
    def execute(self, context):
        materials.apply_preset(material_of(context), PRESETS[self.preset])
        return {"FINISHED"}


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


class PLAUSIBLE_OT_bake_weights(OnMaterial, bpy.types.Operator):
    """Bake the weights that the material renders by, for the values that its sockets hold and over ranges of those that
    links, drivers or keyframes change. It takes some seconds, and Blender stays usable"""

    bl_idname = "plausible.bake_weights"
    bl_label = "Bake Weights"

    @reporting
    def execute(self, context):
        material = material_of(context)
        if bpy.app.background:
            nodes.bake_weights(plausible_node(material)[0])
        else:
            rebake.soon(material)
        return {"FINISHED"}


class PLAUSIBLE_OT_cancel_weights(OnMaterial, bpy.types.Operator):
    """End the bake of these weights; the material keeps those that it has"""

    bl_idname = "plausible.cancel_weights"
    bl_label = "Cancel"
    bl_options = {"INTERNAL"}

    def execute(self, context):
        rebake.cancel(material_of(context))
        return {"FINISHED"}


class PLAUSIBLE_MT_presets(bpy.types.Menu):
    """Materials by name"""

    bl_idname = "PLAUSIBLE_MT_presets"
    bl_label = "Presets"

    def draw(self, context):
        for menu in _GROUP_MENUS:
            self.layout.menu(menu.bl_idname)


class _OfGroup:
    """A menu of the presets of one group."""

    def draw(self, context):
        for name, preset in PRESETS.items():
            if preset.group == self.bl_label:
                icon = icons.icon_of(name)
                self.layout.operator("plausible.apply_preset", text=preset.label, icon_value=icon).preset = name


def _group_menus():
    groups = dict.fromkeys(preset.group for preset in PRESETS.values())
    return tuple(type(name, (_OfGroup, bpy.types.Menu), {"bl_idname": name, "bl_label": group})
                 for group in groups for name in [f"PLAUSIBLE_MT_presets_{group.lower().replace(' ', '_')}"])


_GROUP_MENUS = _group_menus()


class PLAUSIBLE_OT_upgrade(bpy.types.Operator):
    """Bring all nodes that an earlier version of the extension made up to this one; values, links and keyframes stay"""

    bl_idname = "plausible.upgrade"
    bl_label = "Upgrade Materials"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return osl_works(cls)

    def execute(self, context):
        said = upgrade.upgrade_all() or "No node is of an earlier version"
        self.report({"WARNING"} if upgrade.outdated() else {"INFO"}, said)
        return {"FINISHED"}


class PLAUSIBLE_OT_update_materials(bpy.types.Operator):
    """Compile the shaders of all Plausible BRDF nodes in this file again, with today's tables; values stay"""

    bl_idname = "plausible.update_materials"
    bl_label = "Update Materials"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return osl_works(cls)

    @reporting
    def execute(self, context):
        upgrade.upgrade_all()
        ours = [node for tree in nodes.trees() for node in tree.nodes if nodes.model_of(node) is not None]
        for node in ours:
            nodes.bake_weights(node)
        self.report({"INFO"}, f"{len(ours)} nodes updated")
        return {"FINISHED"}


CLASSES = (
    PLAUSIBLE_OT_new_material, PLAUSIBLE_OT_use_osl, PLAUSIBLE_OT_set_metal, PLAUSIBLE_MT_metals,
    PLAUSIBLE_OT_apply_preset, PLAUSIBLE_OT_convert, PLAUSIBLE_MT_convert, PLAUSIBLE_OT_bake_weights,
    PLAUSIBLE_OT_cancel_weights, PLAUSIBLE_MT_presets, *_GROUP_MENUS, PLAUSIBLE_OT_upgrade,
    PLAUSIBLE_OT_update_materials,
)
