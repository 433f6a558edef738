"""The panels, in the material tab and in the shader editor's sidebar."""
import textwrap

import bpy

from ...forms.albedo import tabulated
from ...models.disk_model import DiskModel
from ...models.parameters import COLOR, LOBE, RETROREFLECTION
from .. import backend as backends
from ..host import table_folder, table_job
from ..host.translation import tr, translate
from ..material import driven, row_jobs
from ..material.baked_state import baked_error, is_stale
from ..material.groups import model_of
from ..material.sockets import is_linked, socket_of, values
from . import icons, notices
from .operators import pumping, table_bake
from .operators.common import material_of, plausible_node
from .properties import NAMES, RANGES

# Parameters that count only where exponents vary with the angle.
_AT_GRAZING = {"grazing_exponent", "retro_grazing_exponent"}
# Error of a lobe, as a fraction of the albedo, above which the panel shows a warning.
_COARSE = 0.1
# Parameters that a metal sets.
_METAL_IDS = {"base_color", "ior", "extinction"}
# Parameters that only some choices of Fresnel read: they are shown with these choices only.
_ONLY_WITH = {"f90": ("schlick",), "ior": ("conductor",), "extinction": ("conductor",),
              "base_color": ("constant", "schlick")}


def draw_text(layout, context, text, icon="NONE"):
    """Draw `text`, translated and wrapped to the width of the region. The icon stands before the first line."""
    scale = context.preferences.system.ui_scale
    # In letters: about 6.5 pixels each, and 70 pixels for margins and icon.
    width = max(20, int((context.region.width / scale - 70) / 6.5))
    column = layout.column(align=True)
    column.scale_y = 0.8
    for line in textwrap.wrap(translate(text), width):
        column.label(text=line, icon=icon)
        icon = "BLANK1" if icon != "NONE" else "NONE"


def draw_notice(layout, context, notice):
    """Draw a notice in a box, with its buttons."""
    box = layout.box()
    draw_text(box, context, notice.text, notice.icon)
    row = box.row(align=True)
    for cure in notice.cures:
        if cure.operator == "plausible.choose_bake":
            draw_bake(row, cure.settings.get("models"))
            continue
        button = row.operator(cure.operator, text=cure.label)
        for name, value in cure.settings.items():
            setattr(button, name, value)


def draw_bake(layout, models=None):
    """Draw the progress of a running table bake with a button to cancel it, else the button of the bake dialog.

    `models` are the ids of the models that the dialog proposes; None proposes all.
    """
    if table_job.job is None or not table_job.job.running:
        button = layout.operator("plausible.choose_bake", icon="RENDER_STILL")
        if models:
            button.models = models
        return
    row = layout.row(align=True)
    row.progress(factor=table_job.job.share, text=table_bake.progress_text(table_job.job))
    row.operator("plausible.cancel_bake", text="", icon="X")


def draw_parameter(layout, material, node, parameter):
    """Draw one parameter: its slider or the node linked to its socket, and its range where it is driven and baked."""
    socket = socket_of(node, parameter)
    if socket is None:
        return
    group, name = material.plausible_brdf, NAMES[parameter]
    if socket.is_linked:
        _draw_link(layout, parameter.label, socket.links[0].from_node)
    elif parameter.kind == "color" and parameter.maximum > 1.0:
        column = layout.column(align=True)
        column.prop(group, name, index=0, text=f"{parameter.label}  R")
        column.prop(group, name, index=1, text="G")
        column.prop(group, name, index=2, text="B")
    elif parameter.kind != "vector":  # a direction is for links only, as three numbers would be hard to read
        layout.prop(group, name, text=parameter.label)
    if parameter in RANGES and driven.is_driven(node, parameter):
        layout.row(align=True).prop(group, RANGES[parameter])


def _draw_link(layout, label, node):
    """Draw a parameter's label and the node that is linked to it, grayed out."""
    split = layout.split(factor=0.4)
    split.enabled = False
    name = split.row()
    name.alignment = "RIGHT"
    name.label(text=label)
    split.label(text=node.label or node.name, icon="LINKED")


class Face:
    """The common part of a panel in the material tab and in the shader editor."""

    @classmethod
    def poll(cls, context):
        return cls.is_here(context) and plausible_node(material_of(context))[1] is not None

    def begin(self, context):
        """(layout, material, node, model), with the layout set up as in Blender's own material panels."""
        material = material_of(context)
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False  # keyframes belong on the node's sockets, which store the values
        layout.enabled = material is None or material.is_editable
        return (layout, material, *plausible_node(material))


class _Main(Face):
    bl_label = "Plausible BRDF"

    @classmethod
    def poll(cls, context):
        return cls.is_here(context)

    def draw(self, context):
        layout, material, node, model = self.begin(context)
        for notice in notices.notices(context, node, material):
            draw_notice(layout, context, notice)
        if model is None:
            layout.operator("plausible.new_material", icon="ADD")
            return
        # The choice of the model, by picture and by name.
        if icons.icon_of(model.id):
            layout.template_icon_view(material.plausible_brdf, "model", show_labels=True, scale=4.0, scale_popup=4.0)
        row = layout.row(align=True)
        row.prop(material.plausible_brdf, "model")
        row.operator("plausible.new_material", text="", icon="ADD").model = model.id
        row.menu("PLAUSIBLE_MT_convert", text="", icon="ARROW_LEFTRIGHT")
        row.menu("PLAUSIBLE_MT_presets", text="", icon="PRESET")
        draw_weights(layout, context, material, node)
        # A reminder of the scene's setting.
        if context.scene.render.engine == "CYCLES" and backends.DEFAULT.is_ready(context.scene):
            note = layout.row()
            note.active = False
            draw_text(note, context, "Open Shading Language is on for this scene", "INFO")


def draw_weights(layout, context, material, node):
    """Draw the state of a baked model's lobe rows: a bake's progress, that they are stale, or their error."""
    if row_jobs.is_running(material):
        done, total = row_jobs.progress(material)
        row = layout.row(align=True)
        text = "Baking the weights over ranges" if driven.ranges(node) else "Baking the weights for these values"
        row.progress(factor=done / total, text=translate(text))
        row.operator("plausible.cancel_weights", text="", icon="X")
    elif is_stale(node):
        box = layout.box()
        problem = row_jobs.problem(material, node)
        draw_text(box, context, problem or "The weights are for other values", "ERROR" if problem else "TIME")
        box.operator("plausible.bake_weights")
    elif baked_error(node):
        note = layout.row()
        note.active = False
        lobe, albedo = (f"{100.0 * fraction:.2g}" for fraction in baked_error(node))
        names = ", ".join(tr(model_of(node).parameter(name).label) for name in driven.ranges(node))
        text = ("Baked over ranges of {names}: up to 80° lobes are within {lobe} %, their light within {albedo} %"
                if names else "Baked: up to 80° lobes are within {lobe} %, their light within {albedo} %")
        draw_text(note, context, tr(text, names=names, lobe=lobe, albedo=albedo),
                  "CHECKMARK" if baked_error(node)[0] <= _COARSE else "ERROR")


class _Lobe(Face):
    bl_label = "Lobe"

    def draw(self, context):
        layout, material, node, model = self.begin(context)
        shown = [p for p in model.parameters if p.section == LOBE and _at_this_angle(p, material, model)]
        by_id = {p.id: p for p in shown}
        hidden = _unused_width(material, node, by_id)
        for parameter in shown:
            if parameter.id != hidden and parameter.id != "use_roughness":
                draw_parameter(layout, material, node, parameter)
            # The switch between exponent and roughness stands under them.
            if parameter.id == "roughness" and "use_roughness" in by_id:
                row = layout.row(align=True)
                draw_parameter(row, material, node, by_id["use_roughness"])
                row.operator("plausible.switch_width", text="", icon="ARROW_LEFTRIGHT")
        # The comparison with the model before pumping.
        if "pumps" in by_id:
            before = pumping.shows_before(node)
            layout.operator("plausible.compare_pumping", text="Show after Pumping" if before else "Show before Pumping",
                            icon="HIDE_OFF" if before else "HIDE_ON", depress=before)
        draw_hint(layout, context, node, model)


def draw_hint(layout, context, node, model):
    """Draw a note where lumps are shrunk to stay on the disk."""
    if isinstance(model, DiskModel) and model.is_held(model.resolve(values(node))):
        note = layout.column()
        note.active = False
        draw_text(note, context, "Seen at a slant the lump is shrunk to a radius of 1 - sin θ, its shape kept, so that "
                                 "it stays on the disk and no light is lost", "INFO")


def _at_this_angle(parameter, material, model):
    """Whether a parameter is shown: exponents at grazing only where exponents vary, or a link may let them vary."""
    if parameter.id not in _AT_GRAZING:
        return True
    node = plausible_node(material)[0]
    return is_linked(node, model.parameter("vary_exponents")) or material.plausible_brdf.vary_exponents


def _has(context, section):
    """Whether the shown material's model has parameters of a section."""
    return any(p.section == section for p in plausible_node(material_of(context))[1].parameters)


class _Retro(Face):
    bl_label = "Retroreflection"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and _has(context, RETROREFLECTION)

    def draw(self, context):
        layout, material, node, model = self.begin(context)
        for parameter in model.parameters:
            if parameter.section == RETROREFLECTION and _at_this_angle(parameter, material, model):
                draw_parameter(layout, material, node, parameter)


def _unused_width(material, node, by_id):
    """The unused one of "exponent" and "roughness"; None without the choice, or where a link decides it."""
    if "use_roughness" not in by_id or is_linked(node, by_id["use_roughness"]):
        return None
    return "exponent" if material.plausible_brdf.use_roughness else "roughness"


class _Color(Face):
    bl_label = "Color"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and _has(context, COLOR)

    def draw(self, context):
        layout, material, node, model = self.begin(context)
        by_id = {p.id: p for p in model.parameters if p.section == COLOR}
        if "fresnel_type" in by_id:
            draw_parameter(layout, material, node, by_id["fresnel_type"])
        for name, parameter in by_id.items():
            if name != "fresnel_type" and _is_read(name, by_id, material, node):
                draw_parameter(layout, material, node, parameter)
        if _METAL_IDS & set(by_id):
            split = layout.split(factor=0.4)
            split.label()
            split.menu("PLAUSIBLE_MT_metals", text="Set Metal")


def _is_read(name, by_id, material, node):
    """Whether the choice of Fresnel uses the parameter `name`. A linked choice may use any."""
    if name not in _ONLY_WITH or "fresnel_type" not in by_id or is_linked(node, by_id["fresnel_type"]):
        return True
    return material.plausible_brdf.fresnel_type in _ONLY_WITH[name]


class _Sampling(Face):
    bl_label = "Sampling"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, material, node, model = self.begin(context)
        for parameter in model.parameters:
            if not parameter.evaluated:
                draw_parameter(layout, material, node, parameter)


class _Tables(Face):
    bl_label = "Albedo Tables"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and bool(tabulated.tables_of(plausible_node(material_of(context))[1]))

    def draw(self, context):
        layout, model = self.layout, plausible_node(material_of(context))[1]
        draw_tables(layout, context, tabulated.tables_of(model))
        draw_bake(layout, {model.id})
        layout.operator("plausible.update_materials", icon="FILE_REFRESH")
        job = table_job.job
        if job is not None and not job.running and job.error is None and not job.cancelled:
            draw_text(layout, context, "Materials keep the tables compiled into them until they are updated", "INFO")


def draw_tables(layout, context, names):
    """Draw the size, range of exponents and measured error of the tables `names` in use, and the folder's problem."""
    if table_folder.folder_problem:
        draw_text(layout, context, table_folder.folder_problem, "ERROR")
    for name in names:
        if table_folder.problem([name]) is None:
            text, inexact = table_bake.described(name)
            draw_text(layout, context, text, "ERROR" if inexact else "CHECKMARK")
    if table_folder.own_tables():
        layout.operator("plausible.shipped_luts", icon="LOOP_BACK")


class _InMaterialTab:
    """The place of panels in the material tab of the properties editor."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "material"
    COMPAT_ENGINES = {"CYCLES"}

    @classmethod
    def is_here(cls, context):
        # A Plausible material shows its panel with notices under every engine.
        return context.engine in cls.COMPAT_ENGINES or plausible_node(material_of(context))[1] is not None


class _InShaderEditor:
    """The place of panels in the shader editor's sidebar."""

    bl_space_type = "NODE_EDITOR"
    bl_region_type = "UI"
    bl_category = "Plausible"

    @classmethod
    def is_here(cls, context):
        space = context.space_data
        return (space.tree_type == "ShaderNodeTree" and space.shader_type == "OBJECT"
                and isinstance(space.id, (bpy.types.Material, type(None))))  # the shader type "OBJECT" includes lights


def in_both_places(faces):
    """Panel classes of each face in both places. `_Main` is the parent of all others, and has to come first."""
    panels = []
    for place, prefix in ((_InMaterialTab, "PLAUSIBLE_PT"), (_InShaderEditor, "PLAUSIBLE_PT_node")):
        for face in faces:
            name = f"{prefix}_{face.__name__.strip('_').lower()}"
            parent = {} if face is _Main else {"bl_parent_id": f"{prefix}_main"}
            panels.append(type(name, (face, place, bpy.types.Panel), {"bl_idname": name, **parent}))
    return tuple(panels)


CLASSES = in_both_places((_Main, _Lobe, _Retro, _Color, _Sampling, _Tables))
