"""Operators: new materials, metals, switching OSL on, and baking the albedo tables."""
import functools
import time

import bpy

from ..brdf import MODELS
from ..brdf.metals import METALS
from ..brdf.presets import PRESETS
from . import icons, luts, materials, osl
from .properties import MODEL_ITEMS

_PRESET_ITEMS = [(name, preset.label, preset.help, i) for i, (name, preset) in enumerate(PRESETS.items())]
_METAL_ITEMS = [(name, metal.label, metal.reference, i) for i, (name, metal) in enumerate(METALS.items())]
_TICK = 0.1  # seconds between two looks at a bake


def _reporting(execute):
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
    """(Script node, model) of a material made here; (None, None) for any other."""
    node = materials.script_node(material) if material else None
    model = materials.model_of(node) if node else None
    return (node, model) if model else (None, None)


def _osl_works(cls):
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
        return _osl_works(cls)

    @_reporting
    def execute(self, context):
        material = materials.create_material(self.model)
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
        return context.scene is not None and _osl_works(cls)

    def execute(self, context):
        materials.use_osl(context.scene)
        return {"FINISHED"}


class _OnMaterial:
    """An operator that changes the material shown, and can be undone."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        material = material_of(context)
        return material is not None and material.is_editable and plausible_node(material)[1] is not None


class PLAUSIBLE_OT_set_metal(_OnMaterial, bpy.types.Operator):
    """Set colour, edge colour, n and k to those of a metal; the choice of Fresnel stays"""

    bl_idname = "plausible.set_metal"
    bl_label = "Set Metal"

    metal: bpy.props.EnumProperty(name="Metal", items=_METAL_ITEMS)

    @classmethod
    def description(cls, context, properties):
        return f"Set colour, n and k to those of {METALS[properties.metal].label.lower()}; the choice of Fresnel stays"

    @_reporting
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


class PLAUSIBLE_OT_apply_preset(_OnMaterial, bpy.types.Operator):
    """Turn the material into a preset: its model and all of its parameters; what is plugged in stays"""

    bl_idname = "plausible.apply_preset"
    bl_label = "Apply Preset"

    preset: bpy.props.EnumProperty(name="Preset", items=_PRESET_ITEMS)

    @classmethod
    def description(cls, context, properties):
        return PRESETS[properties.preset].help

    @_reporting
    def execute(self, context):
        materials.apply_preset(material_of(context), PRESETS[self.preset])
        return {"FINISHED"}


class PLAUSIBLE_OT_convert(_OnMaterial, bpy.types.Operator):
    """Turn the material into another model whose lobe is as wide, which takes some seconds where the model is baked"""

    bl_idname = "plausible.convert"
    bl_label = "Convert"

    model: bpy.props.EnumProperty(name="Model", items=MODEL_ITEMS)

    @classmethod
    def description(cls, context, properties):
        return f"Turn the material into {MODELS[properties.model].label}, its lobe as wide as now"

    @_reporting
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
                icon = icons.of_model(model.id)
                self.layout.operator("plausible.convert", text=model.label, icon_value=icon).model = model.id


class PLAUSIBLE_OT_bake_weights(_OnMaterial, bpy.types.Operator):
    """Bake the weights that the material renders by for the values that its sockets hold, which takes some seconds"""

    bl_idname = "plausible.bake_weights"
    bl_label = "Bake Weights"

    @_reporting
    def execute(self, context):
        materials.bake_weights(plausible_node(material_of(context))[0])
        return {"FINISHED"}


class PLAUSIBLE_MT_presets(bpy.types.Menu):
    """Materials by name"""

    bl_idname = "PLAUSIBLE_MT_presets"
    bl_label = "Presets"

    def draw(self, context):
        for name, preset in PRESETS.items():
            icon = icons.of_preset(name)
            self.layout.operator("plausible.apply_preset", text=preset.label, icon_value=icon).preset = name


class PLAUSIBLE_OT_bake_luts(bpy.types.Operator):
    """Compute the albedo tables anew, which takes a minute or two. Blender stays usable meanwhile; Escape cancels"""

    bl_idname = "plausible.bake_luts"
    bl_label = "Bake LUTs"

    @classmethod
    def poll(cls, context):
        if luts.job is not None and luts.job.running:
            cls.poll_message_set("A bake is running")
            return False
        return True

    def invoke(self, context, event):
        if not self._start():
            return {"CANCELLED"}
        self._timer = context.window_manager.event_timer_add(_TICK, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            luts.job.cancel()
        if event.type != "TIMER" or luts.job is None:
            return {"PASS_THROUGH"}
        context.window_manager.progress_update(100 * luts.job.share)
        context.workspace.status_text_set(f"{progress_text(luts.job)}   Esc: cancel")
        _redraw(context)
        if luts.job.running:
            return {"PASS_THROUGH"}
        self._leave(context)
        return self._end()

    def execute(self, context):
        """Bake to the end before returning: for scripts and background mode, where nothing is modal."""
        if not self._start():
            return {"CANCELLED"}
        luts.job.wait()
        return self._end()

    def cancel(self, context):
        """Blender ends the operator, as when another file is opened."""
        if luts.job is not None:
            luts.job.cancel()
        self._leave(context)

    def _start(self):
        self._began = time.monotonic()
        luts.job = luts.BakeJob()
        try:
            luts.job.start()
        except OSError as error:
            luts.job = None
            self.report({"ERROR"}, f"The albedo tables cannot be written: {error}")
            return False
        return True

    def _leave(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        _redraw(context)

    def _end(self):
        if luts.job.error is not None:
            self.report({"ERROR"}, f"The bake failed: {luts.job.error}")
            return {"CANCELLED"}
        if luts.job.cancelled:
            self.report({"WARNING"}, "The bake is cancelled; tables that were not complete are as they were")
            return {"CANCELLED"}
        seconds = time.monotonic() - self._began
        seconds = time.monotonic() - self._began
        self.report({"INFO"}, f"{len(luts.job.names)} tables baked in {seconds:.0f} s. Materials keep the tables that "
                              "are compiled into them until Update Materials")
        return {"FINISHED"}


def progress_text(job) -> str:
    """What the bake is doing, for panel and status bar."""
    return "Cancelling" if job.cancelling else f"Baking {job.table.replace('_', ' ')}, {100 * job.share:.0f} %"


def _redraw(context):
    """Have the areas that show the panel drawn again."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in ("PROPERTIES", "NODE_EDITOR", "PREFERENCES"):
                area.tag_redraw()


class PLAUSIBLE_OT_cancel_bake(bpy.types.Operator):
    """End the bake; tables that are not complete keep their old files"""

    bl_idname = "plausible.cancel_bake"
    bl_label = "Cancel"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context):
        return luts.job is not None and luts.job.running

    def execute(self, context):
        luts.job.cancel()
        return {"FINISHED"}


class PLAUSIBLE_OT_update_materials(bpy.types.Operator):
    """Compile the shaders of all Plausible BRDF materials in this file again, with today's tables; values stay"""

    bl_idname = "plausible.update_materials"
    bl_label = "Update Materials"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return _osl_works(cls)

    @_reporting
    def execute(self, context):
        updated = [m for m in bpy.data.materials if m.is_editable and plausible_node(m)[1] is not None]
        for material in updated:
            materials.rebuild(material)
        self.report({"INFO"}, f"{len(updated)} materials updated")
        return {"FINISHED"}


CLASSES = (
    PLAUSIBLE_OT_new_material, PLAUSIBLE_OT_use_osl, PLAUSIBLE_OT_set_metal, PLAUSIBLE_MT_metals,
    PLAUSIBLE_OT_apply_preset, PLAUSIBLE_OT_convert, PLAUSIBLE_MT_convert, PLAUSIBLE_OT_bake_weights,
    PLAUSIBLE_MT_presets,
    PLAUSIBLE_OT_bake_luts, PLAUSIBLE_OT_cancel_bake, PLAUSIBLE_OT_update_materials,
)
