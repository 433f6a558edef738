"""The OSL backend: a Script node that contains a model's compiled shader. It renders in Cycles, on the CPU."""
import hashlib
import re
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import bpy

from ...backends.osl import assembler, estimator
from ...forms.albedo import tables, tabulated
from ...forms.rows import error as rows_error
from ...forms.rows import grid, row_bake
from ..host import row_cache, table_folder
from ..host.translation import tr
from .protocol import BSDF, MODEL_KEY, BackendError, Cure, Notice, Program, pair_of, refuse_options, stored, text_of

SCRIPT = "ShaderNodeScript"
# Custom property of a group: where its shader has the albedo tables, see `assembler.assemble`.
LUT_KEY = "plausible_lut"
# Custom property of a group: {table: (least, largest) exponent} of the tables that are compiled into its shader.
SPANS_KEY = "plausible_spans"
GET_BLENDER = Cure("wm.url_open", "Get Blender", {"url": "https://www.blender.org/download/"})
# A switch is an int in OSL, and Blender 5.0 crashes on a boolean socket that is linked from a group to a Script node.
_SOCKETS = {"float": "NodeSocketFloat", "int": "NodeSocketInt", "enum": "NodeSocketInt", "bool": "NodeSocketInt",
            "color": "NodeSocketColor", "vector": "NodeSocketVector", "image": "NodeSocketString"}
_compiled = {}  # MD5 of a shader's source -> its bytecode


class OslError(BackendError):
    """This Blender cannot run the shaders. The message gives the reason and a remedy."""


@dataclass(frozen=True)
class Osl:
    """See `protocol.Backend`.

    `lut` is "compiled" (the albedo tables are part of the shader) or "file" (the shader reads them from image files).
    """

    lut: str = assembler.COMPILED

    id = "osl"
    label = "Open Shading Language"

    def with_options(self, lut: str = assembler.COMPILED, **others) -> "Osl":
        """See `Backend`."""
        refuse_options(self, others)
        if lut not in (assembler.COMPILED, assembler.FILE):
            raise ValueError(f"lut: {lut!r} is not one of {assembler.COMPILED}, {assembler.FILE}")
        return replace(self, lut=lut)

    def as_kept(self, group) -> "Osl":
        """See `Backend`."""
        return replace(self, lut=assembler.FILE if text_of(group, LUT_KEY) == assembler.FILE else assembler.COMPILED)

    def keep_options(self, group):
        """See `Backend`."""
        group[LUT_KEY] = self.lut

    def why_not(self, scene=None) -> tuple:
        """See `Backend`."""
        reason = unavailable()
        if reason:
            return (Notice(reason, (GET_BLENDER,)),)
        if scene is None or scene.render.engine != "CYCLES":
            return ()
        return tuple(notice for notice in (_switched_off(scene), _wrong_device(scene)) if notice is not None)

    def is_ready(self, scene) -> bool:
        """See `Backend`: whether Open Shading Language is switched on."""
        return scene.cycles.shading_system

    def prepare(self, scene) -> bool:
        """See `Backend`: switches Open Shading Language on."""
        was_off = not scene.cycles.shading_system
        scene.cycles.shading_system = True
        return was_off

    def notices(self, node, model, values) -> tuple:
        """See `Backend`: exponents beyond the tables compiled into the shader, and table files that cannot be read."""
        problems = [table_folder.problem_of(name, path) for name, path in table_files(node.node_tree, model).items()]
        unreadable = [Notice(text) for text in problems if text]
        notices = [_beyond(model, values, spans_of(node.node_tree)), *unreadable[:1]]
        return tuple(notice for notice in notices if notice is not None)

    def parameters(self, model) -> tuple:
        """See `Backend`: all, as the shader has an input for each."""
        return model.parameters

    def follows_sockets(self, model) -> bool:
        """See `Backend`: true for models with a shader of their own; other models render from baked lobe rows."""
        return not estimator.is_baked(model)

    def can_share(self, model) -> bool:
        """See `Backend`: false where the shader reads table files, whose paths are stored inside the group."""
        return self.follows_sockets(model) and self.lut == assembler.COMPILED

    def check(self, model, values):
        """See `Backend`. Raises brdf.TableError where a compiled-in table is missing or not baked for an exponent."""
        for table, exponent in tabulated.readings(model, values) if self.lut == assembler.COMPILED else ():
            tables.require(table, exponent)

    def program(self, model, values=None, ranges=None) -> Program:
        """See `Backend`. Raises OslError where the shader does not compile, brdf.TableError for an unusable table."""
        reason = unavailable()
        if reason:
            raise OslError(reason)
        # Baking lobe rows takes seconds, so bytecode with rows is cached on disk.
        if not self.follows_sockets(model):
            return self._program(model, row_cache.fetch(
                row_cache.key(model, values or {}, "shader", ranges),
                lambda: compile_text(model, assembler.assemble(model, self.lut, values, ranges))))
        return self._program(model, _compiled_once(model, assembler.assemble(model, self.lut, values)))

    def blank(self, model) -> Program:
        """See `Backend`: a material with this program renders striped."""
        rows = grid.ParameterGrid((), (row_bake.blank(model, {}),))
        text = assembler.assemble(model, baked=rows, defines={"MODEL_MATCHES": "0"})
        return self._program(model, _compiled_once(model, text))

    def is_cached(self, model, values, ranges) -> bool:
        """See `Backend`."""
        return all(row_cache.holds(row_cache.key(model, values, what, ranges)) for what in ("shader", "error"))

    def prefetch(self, model, values, ranges, tell):
        """See `Backend`: bakes the lobe rows, which `grid.bake` keeps."""
        grid.bake(model, values, ranges, tell=tell)

    def error(self, model, values, ranges) -> tuple | None:
        """See `Backend`: the error of the lobe rows."""
        return rows_error.largest(model, values, ranges)

    def install(self, group, model, program, inputs):
        """See `Backend`. The sockets are made here, as versions of Blender make a Script node's sockets differently."""
        script = group.nodes.new(SCRIPT)
        script.label, script.width, script.location = model.label, 220.0, (0.0, 300.0)
        # A socket for each parameter, linked to the group's socket where there is one.
        for parameter in model.parameters:
            socket = script.inputs.new(_SOCKETS[parameter.kind], parameter.label, identifier=parameter.id)
            socket.default_value = stored(socket, parameter.default)
            if parameter.id in inputs:
                group.links.new(inputs[parameter.id], socket)
        # A socket for the path of each albedo table that the shader reads from a file.
        for name in tabulated.tables_of(model) if self.lut == assembler.FILE else ():
            table = tables.TABLES[name]
            mode = assembler.mode_of(table)
            socket = script.inputs.new("NodeSocketString", f"Table ({mode})", identifier=f"table_{mode}")
            socket.default_value = str(table.path)
        script.outputs.new("NodeSocketShader", BSDF, identifier=BSDF)
        self.update(group, program)
        return script.outputs[BSDF]

    def update(self, group, program):
        """See `Backend`."""
        script = script_in(group)
        if script.bytecode != program.content:
            fill(script, program.content)
        group[SPANS_KEY] = {name: span for name, *span in program.spans}

    def output(self, group):
        """See `Backend`."""
        script = script_in(group)
        return None if script is None else script.outputs.get(BSDF)

    def installed(self, group) -> Program | None:
        """See `Backend`. Bytecode counts as damaged unless it begins with the header of compiled OSL."""
        script = script_in(group)
        if script is None or script.mode != "INTERNAL" or not script.bytecode.startswith("OpenShadingLanguage"):
            return None
        spans = tuple((name, *span) for name, span in spans_of(group).items())
        return Program(self.id, text_of(group, MODEL_KEY), script.bytecode, spans)

    def unfed(self, group, fed_by) -> list:
        """See `Backend`."""
        script = script_in(group)
        if script is None:
            return []
        sources = {socket.identifier: _source_of(socket) for socket in script.inputs}
        return [name for name, identifier in fed_by.items() if sources.get(name, identifier) != identifier]

    def _program(self, model, bytecode):
        """`bytecode` as a Program, with the exponent ranges of the model's tables."""
        spans = tuple((name, *span) for name, span in assembler.spans(model).items())
        return Program(self.id, model.id, bytecode, spans)


# Obstacles to rendering.

def unavailable() -> str | None:
    """Why this build of Blender cannot run OSL, or None where it can."""
    try:
        import _cycles
    except ImportError:
        return "This Blender was built without Cycles; Plausible BRDF renders in Cycles only"
    if not getattr(_cycles, "with_osl", False):
        return "This Blender was built without Open Shading Language; install the official build from blender.org"
    return None


_NATIVE = Cure("plausible.switch_native", "Native Approximation")


def _switched_off(scene):
    """The notice for a scene with Open Shading Language off, or None."""
    if scene.cycles.shading_system:
        return None
    return Notice("Open Shading Language is off in this scene: Plausible materials render black",
                  (Cure("plausible.use_osl", "Switch on OSL"), _NATIVE))


def _wrong_device(scene):
    """The notice for a scene that renders on the GPU, or None."""
    if scene.cycles.device != "GPU":
        return None
    # On the GPU Cycles reserves 1 KB per hit for OSL's closures, and does not check whether they fit.
    text = ("On the GPU these materials ask for more room than Cycles has: render on the CPU, or what Cycles ships in "
            "place of the model" if supports_osl(scene) else
            "OSL on GPU needs OptiX, and these materials more room than Cycles has there: render on the CPU, or what "
            "Cycles ships in place of the model")
    on_cpu = Cure("wm.context_set_enum", "Render on CPU", {"data_path": "scene.cycles.device", "value": "CPU"})
    return Notice(text, (on_cpu, _NATIVE))


def supports_osl(scene) -> bool:
    """Whether the scene renders OSL on its device: always on the CPU, on a GPU only with OptiX."""
    if scene.cycles.device != "GPU":
        return True
    addon = bpy.context.preferences.addons.get("cycles")
    return addon is not None and addon.preferences.compute_device_type in ("NONE", "OPTIX")


def _beyond(model, values, spans):
    """The notice for an exponent outside the tables in a material's shader, or None.

    `spans` is {table: (least, largest) exponent}.
    """
    for name, exponent in tabulated.readings(model, model.resolve(values)):
        span = spans.get(name)
        if span is None or tables.covers(span, exponent):
            continue
        text = tr("Exponent {exponent:.6g} is beyond the material's tables, which are for {low:g} to {high:g}: it "
                   "renders striped", exponent=exponent, low=span[0], high=span[1])
        # The tables in use may cover the exponent already; then recompiling suffices.
        if table_folder.problem([name]) is None and tables.covers(tables.in_use(name).span, exponent):
            return Notice(text, (Cure("plausible.update_materials", "Update Materials"),))
        return Notice(text, (Cure("plausible.choose_bake", "Bake LUTs", {"models": {model.id}}),))
    return None


# Compiling.

def check_model(model):
    """Compile a model's shader, for a baked model without lobe rows. Raises as `Osl.program`."""
    backend = Osl()
    if backend.follows_sockets(model):
        backend.program(model)
    else:
        backend.blank(model)


def _compiled_once(model, text):
    """Bytecode of the source `text`, compiled at the first call and then kept in memory."""
    key = hashlib.md5(text.encode()).hexdigest()
    if key not in _compiled:
        _compiled[key] = compile_text(model, text)
    return _compiled[key]


def compile_text(model, text: str) -> str:
    """Bytecode of a shader's OSL source. Raises OslError where it does not compile."""
    import _cycles

    with tempfile.TemporaryDirectory(prefix="plausible_") as folder:
        osl, oso = Path(folder) / f"{model.id}.osl", Path(folder) / f"{model.id}.oso"
        osl.write_text(text, encoding="utf-8")
        if not _cycles.osl_compile(str(osl), str(oso)) or not oso.exists():
            raise OslError(f"the shader of {model.label} did not compile; the console tells why")
        return _normalized(oso.read_text(encoding="utf-8"))


def _normalized(bytecode):
    """Bytecode without traces of the compiling machine, as it is stored in users' .blend files.

    Removes comments, file names and line numbers, and renumbers temporary variables, whose numbers depend on the
    compiler's version.
    """
    lines = [line for line in bytecode.splitlines() if not line.startswith("#")]
    text = re.sub(r'\s%(?:filename|line)\{[^}]*\}', "", "\n".join(lines)) + "\n"
    numbers = {}
    return re.sub(r"___\d+_", lambda match: numbers.setdefault(match[0], f"___{len(numbers)}_"), text)


# The Script node.

def script_in(group):
    """The Script node in a group of ours, or None."""
    return next((node for node in group.nodes if node.bl_idname == SCRIPT and node.outputs), None)


def script_of(node):
    """The Script node inside a node of ours, or None."""
    return script_in(node.node_tree)


def fill(script, bytecode: str):
    """Put bytecode into a Script node."""
    script.mode = "INTERNAL"
    script.bytecode = bytecode
    script.bytecode_hash = hashlib.md5(bytecode.encode()).hexdigest()


def _source_of(socket):
    """The identifier of the group's socket that is linked to a socket inside; None without a link from the group."""
    link = socket.links[0] if socket.is_linked else None
    return link.from_socket.identifier if link and link.from_node.bl_idname == "NodeGroupInput" else None


def table_files(group, model) -> dict:
    """{table: path} of the albedo table files that a group's shader reads; {} where the tables are compiled in."""
    script = script_in(group)
    modes = {f"table_{assembler.mode_of(tables.TABLES[name])}": name for name in tabulated.tables_of(model)}
    return {modes[s.identifier]: Path(bpy.path.abspath(s.default_value)) for s in (script.inputs if script else ())
            if s.identifier in modes and s.type == "STRING"}


def spans_of(group) -> dict:
    """{table: (least, largest) exponent} of the tables compiled into a group's shader.

    Tables without a valid entry in the group's custom property are left out.
    """
    entries = group.get(SPANS_KEY)
    pairs = {name: pair_of(span) for name, span in entries.items()} if hasattr(entries, "items") else {}
    return {name: pair for name, pair in pairs.items() if pair is not None}


@bpy.app.handlers.persistent
def on_load(*_):
    """Clear the hash of Script nodes that have no bytecode, in a loaded file: rendering them would crash Blender."""
    for group in bpy.data.node_groups:
        for node in group.nodes if MODEL_KEY in group and group.is_editable else ():
            if node.bl_idname == SCRIPT and node.bytecode_hash and not node.bytecode:
                node.bytecode_hash = ""


def start():
    """Check every file on loading, see `on_load`."""
    bpy.app.handlers.load_post.append(on_load)


def stop():
    """Stop checking files."""
    if on_load in bpy.app.handlers.load_post:
        bpy.app.handlers.load_post.remove(on_load)
