"""The operators that bake albedo tables: a dialog for models, resolution and exponents, and the bake itself."""
import bpy

from ....forms.albedo import bake, sizes, tables, tabulated
from ....models.parameters import MAX_EXPONENT, MIN_EXPONENT
from ...host import table_folder, table_job
from ...host.redraw import redraw

_TICK = 0.1  # seconds between two looks at a bake
# Items of the flags for models: (id, label, names of tables, bit).
_MODEL_ITEMS = [(model.id, model.label, ", ".join(name.replace("_", " ") for name in tabulated.tables_of(model)),
                 1 << i)
                for i, model in enumerate(sizes.readers())]
_RESOLUTION_ITEMS = [(name, chosen.label, chosen.help[0].upper() + chosen.help[1:], i)
                     for i, (name, chosen) in enumerate(sizes.RESOLUTIONS.items())]


class _Choice:
    """The properties of both operators: which tables to bake, and how."""

    models: bpy.props.EnumProperty(
        name="Models", description="The models whose tables are baked", items=_MODEL_ITEMS,
        options={"ENUM_FLAG", "SKIP_SAVE"}, default={item[0] for item in _MODEL_ITEMS})
    resolution: bpy.props.EnumProperty(name="Resolution", description="How many columns and rows the tables have",
                                       items=_RESOLUTION_ITEMS, default="standard")
    lowest: bpy.props.FloatProperty(
        name="Exponents from", description="The least exponent that the tables are for. Materials beyond the range "
        "render striped", min=MIN_EXPONENT, max=MAX_EXPONENT, default=MIN_EXPONENT, precision=1)
    highest: bpy.props.FloatProperty(
        name="to", description="The largest exponent that the tables are for. With as many rows a shorter range is "
        "finer. Materials beyond the range render striped", min=MIN_EXPONENT, max=MAX_EXPONENT, default=MAX_EXPONENT,
        precision=1)

    @classmethod
    def poll(cls, context):
        if table_job.job is not None and table_job.job.running:
            cls.poll_message_set("A bake is running")
            return False
        return True

    def chosen(self):
        """(names of tables, sizes.Size). Raises ValueError for an invalid choice."""
        if not self.models:
            raise ValueError("No model is chosen: there is nothing to bake")
        return (sizes.tables_of(m.id for m in sizes.readers() if m.id in self.models),
                sizes.Size(self.resolution, self.lowest, self.highest))


class PLAUSIBLE_OT_choose_bake(_Choice, bpy.types.Operator):
    """Choose which albedo tables to compute anew, how fine and for which exponents"""

    bl_idname = "plausible.choose_bake"
    bl_label = "Bake LUTs"

    def invoke(self, context, event):
        return context.window_manager.invoke_props_dialog(self, width=400, confirm_text="Bake")

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.column().prop(self, "models")
        layout.row().prop(self, "resolution", expand=True)
        column = layout.column(align=True)
        column.prop(self, "lowest")
        column.prop(self, "highest")
        lines = layout.column()
        for text, icon in cost_texts(self):
            lines.label(text=text, icon=icon)

    def execute(self, context):
        # The operator of a dialog cannot become modal, so another operator bakes.
        try:
            self.chosen()
            bpy.ops.plausible.bake_luts("INVOKE_DEFAULT", models=self.models, resolution=self.resolution,
                                        lowest=self.lowest, highest=self.highest)
        except (RuntimeError, ValueError) as error:
            self.report({"ERROR"}, str(error).removeprefix("Error: ").strip())
            return {"CANCELLED"}
        return {"FINISHED"}


def cost_texts(choice) -> list:
    """[(line, icon)]: size, time and accuracy of a bake, or the error of an invalid choice."""
    try:
        names, size = choice.chosen()
    except ValueError as error:
        return [(str(error)[:1].upper() + str(error)[1:], "ERROR")]
    # Estimates of size, time and interpolation error.
    baked = [sizes.sized(tables.TABLES[name], size) for name in names]
    kilobytes = sum(map(sizes.bytes_of, baked)) / 1000.0
    seconds = sum(map(sizes.seconds_of, baked))
    bound = 100.0 * sizes.bound(size.resolution, bake.INTERPOLATION_BOUND)
    inexact = size.resolution == "draft"
    # The lines.
    lines = [(f"{len(baked)} tables, {kilobytes:.0f} KB, about {seconds:.0f} s; Blender stays usable", "TIME"),
             (f"{'Inexact: albedos' if inexact else 'Albedos'} within {bound:.2g} %; it is measured",
              "ERROR" if inexact else "CHECKMARK")]
    if not size.is_whole:
        lines.append((f"Materials of exponents beyond {size.lowest:g} to {size.highest:g} render striped", "INFO"))
    return lines


class PLAUSIBLE_OT_bake_luts(_Choice, bpy.types.Operator):
    """Compute the albedo tables anew. Blender stays usable meanwhile; Escape cancels"""

    bl_idname = "plausible.bake_luts"
    bl_label = "Bake LUTs"

    def invoke(self, context, event):
        if not self._start():
            return {"CANCELLED"}
        self._timer = context.window_manager.event_timer_add(_TICK, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS" and table_job.job is not None:
            table_job.job.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER" or table_job.job is None:
            return {"PASS_THROUGH"}
        context.window_manager.progress_update(100 * table_job.job.share)
        context.workspace.status_text_set(f"{progress_text(table_job.job)}   Esc: cancel")
        redraw()
        if table_job.job.running:
            return {"PASS_THROUGH"}
        self._leave(context)
        return self._end()

    def execute(self, context):
        """Bake completely before returning: for scripts and background mode, where no operator is modal."""
        if not self._start():
            return {"CANCELLED"}
        table_job.job.wait()
        return self._end()

    def cancel(self, context):
        """Cancel the bake when Blender ends the operator, as when another file is opened."""
        if table_job.job is not None:
            table_job.job.cancel()
        self._leave(context)

    def _start(self):
        """Start the job. Returns whether it started, and reports an error otherwise."""
        try:
            table_job.job = table_job.BakeJob(*self.chosen())
            table_job.job.start()
        except (OSError, ValueError) as error:
            table_job.job = None
            table_folder.choose_folder()
            cannot = "The albedo tables cannot be written: " if isinstance(error, OSError) else ""
            self.report({"ERROR"}, f"{cannot}{in_words(error)}")
            return False
        return True

    def _leave(self, context):
        """Remove the timer, the progress and the status text."""
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        redraw()

    def _end(self):
        """Use the new tables, report the result, and return the operator's result."""
        table_folder.choose_folder()
        if table_job.job.error is not None:
            self.report({"ERROR"}, f"The bake failed: {in_words(table_job.job.error)}. Tables that were not complete "
                                   "are as they were")
            return {"CANCELLED"}
        if table_job.job.cancelled:
            self.report({"WARNING"}, "The bake is cancelled; tables that were not complete are as they were")
            return {"CANCELLED"}
        self.report({"INFO"}, finished_text(table_job.job))
        return {"FINISHED"}


def in_words(error) -> str:
    """An error's message, without its error number."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return str(error)


def finished_text(job) -> str:
    """The report of a finished bake, with the measured error."""
    errors = [tables.stated_error(name) for name in job.names if table_folder.problem([name]) is None]
    measured = f", within {100.0 * max(errors):.2g} % between nodes" if errors and None not in errors else ""
    draft = " Drafts are inexact, for a look only." if job.size.resolution == "draft" else ""
    return (f"{len(job.names)} tables baked in {job.seconds:.0f} s{measured}.{draft} Materials keep the tables that "
            "are compiled into them until Update Materials")


def described(name) -> tuple:
    """(line, whether it is inexact) of a table in use. The line has its name, resolution, axes and measured error."""
    table, error = tables.in_use(name), tables.stated_error(name)
    low, high = table.span
    within = "" if error is None else f", within {100.0 * error:.2g} %"
    resolution = tables.resolution(name)
    label = sizes.RESOLUTIONS[resolution].label if resolution in sizes.RESOLUTIONS else resolution
    text = (f"{name.replace('_', ' ').capitalize()}: {label}, {table.columns.columns} × {table.height}, exponents "
            f"{low:g} to {high:g}{within}")
    return text, error is not None and error > bake.INTERPOLATION_BOUND


def progress_text(job) -> str:
    """The progress of the bake, for panel and status bar."""
    if job.cancelling:
        return "Cancelling"
    left = f", {job.seconds_left:.0f} s left" if job.share > 0.1 else ""
    return f"Baking {job.table.replace('_', ' ')}, {100 * job.share:.0f} %{left}"


class PLAUSIBLE_OT_cancel_bake(bpy.types.Operator):
    """End the bake; tables that are not complete keep their old files"""

    bl_idname = "plausible.cancel_bake"
    bl_label = "Cancel"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context):
        return table_job.job is not None and table_job.job.running

    def execute(self, context):
        table_job.job.cancel()
        return {"FINISHED"}


class PLAUSIBLE_OT_shipped_luts(bpy.types.Operator):
    """Delete the tables that were baked here, and use those that the extension came with"""

    bl_idname = "plausible.shipped_luts"
    bl_label = "Use Shipped Tables"

    @classmethod
    def poll(cls, context):
        return PLAUSIBLE_OT_bake_luts.poll(context)

    def invoke(self, context, event):
        return context.window_manager.invoke_confirm(self, event)

    def execute(self, context):
        try:
            table_folder.delete_own()
        except OSError as error:
            self.report({"ERROR"}, f"The tables cannot be deleted: {in_words(error)}")
            return {"CANCELLED"}
        return {"FINISHED"}


CLASSES = (PLAUSIBLE_OT_choose_bake, PLAUSIBLE_OT_bake_luts, PLAUSIBLE_OT_cancel_bake, PLAUSIBLE_OT_shipped_luts)
