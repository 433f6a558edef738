"""OSL in Blender: whether this build has it, compiling a model's shader, and the Script node that carries it."""
import hashlib
import re
import tempfile
from pathlib import Path

import bpy

from ..baking.rows import grid, row_bake
from ..shading import source
from . import cache

# A switch is an int to OSL, and Blender 5.0 ends on a truth value that goes from a group into a Script node.
SOCKETS = {"float": "NodeSocketFloat", "int": "NodeSocketInt", "enum": "NodeSocketInt", "bool": "NodeSocketInt",
           "color": "NodeSocketColor", "vector": "NodeSocketVector", "image": "NodeSocketString"}
_compiled = {}


class OslError(RuntimeError):
    """This Blender cannot run the shaders; the message says why and what to do."""


def unavailable() -> str | None:
    """Why this Blender cannot run OSL, or None when it can."""
    try:
        import _cycles
    except ImportError:
        return "This Blender was built without Cycles; Plausible BRDF renders in Cycles only"
    if not getattr(_cycles, "with_osl", False):
        return "This Blender was built without Open Shading Language; install the official build from blender.org"
    return None


def compile_model(model, lut: str = source.COMPILED, parameters: dict | None = None,
                  driven: dict | None = None) -> str:
    """Bytecode of a model's shader; of a baked model for its `parameters`, and the ranges of those `driven`.

    Raises OslError when it cannot be compiled, brdf.TableError for a bad table.
    """
    reason = unavailable()
    if reason:
        raise OslError(reason)
    if model.baked:
        return cache.fetch(cache.key(model, parameters or {}, "shader", driven),
                           lambda: compile_text(model, source.assemble(model, lut, parameters, driven)))
    return _compiled_once(model, source.assemble(model, lut, parameters))


def is_kept(model, parameters: dict, driven: dict | None = None) -> bool:
    """Whether the shader of a baked model for its parameters is at hand, so that `compile_model` takes no time."""
    return all(cache.holds(cache.key(model, parameters, what, driven)) for what in ("shader", "error"))


def check_model(model):
    """Compile a model's shader without what is baked for its parameters. Raises as `compile_model`."""
    if model.baked:
        compile_blank(model)
    else:
        compile_model(model)


def compile_blank(model) -> str:
    """Bytecode of a baked model's shader that is for no values, and so striped. Raises OslError when it is wrong."""
    text = source.assemble(model, baked=grid.ParameterGrid((), (row_bake.blank(model, {}),)))
    return _compiled_once(model, text.replace("#define MODEL_MATCHES ", "#define MODEL_MATCHES 0 && "))


def _compiled_once(model, text):
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
        return _by_itself(oso.read_text(encoding="utf-8"))


def _by_itself(bytecode):
    """Bytecode that is the same wherever it is compiled, as it goes into everyone's .blend.

    Comments and file names tell where that was, and compilers of different versions number variables differently.
    """
    lines = [line for line in bytecode.splitlines() if not line.startswith("#")]
    text = re.sub(r'\s%(?:filename|line)\{[^}]*\}', "", "\n".join(lines)) + "\n"
    numbers = {}
    return re.sub(r"___\d+_", lambda found: numbers.setdefault(found[0], f"___{len(numbers)}_"), text)


def add_script_node(tree, model, bytecode: str, lut: str = source.COMPILED):
    """Add a Script node with a model's `bytecode` to a node tree, its sockets made from the registry.

    The sockets are made here, not by Blender: what Blender does to make them differs with version and build.
    """
    node = tree.nodes.new("ShaderNodeScript")
    node.label, node.width = model.label, 220.0
    fill(node, bytecode)
    for parameter in model.parameters:
        socket = node.inputs.new(SOCKETS[parameter.kind], parameter.label, identifier=parameter.id)
        socket.default_value = stored(socket, parameter.default)
    if lut == source.FILE:
        for name in model.tables:
            table = source.tables.TABLES[name]
            mode = source.mode_of(table)
            socket = node.inputs.new("NodeSocketString", f"Table ({mode})", identifier=f"table_{mode}")
            socket.default_value = str(table.path)
    node.outputs.new("NodeSocketShader", "BSDF", identifier="BSDF")
    return node


def stored(socket, value):
    """A parameter's value as its socket holds it: colours have a fourth number."""
    return (*value, 1.0) if isinstance(value, tuple) and len(socket.default_value) == 4 else value


def fill(node, bytecode: str):
    """Put bytecode into a Script node."""
    node.mode = "INTERNAL"
    node.bytecode = bytecode
    node.bytecode_hash = hashlib.md5(bytecode.encode()).hexdigest()


def supports_osl(scene) -> bool:
    """Whether the scene renders OSL on its device: always on the CPU, on a GPU only with OptiX."""
    if scene.cycles.device != "GPU":
        return True
    addon = bpy.context.preferences.addons.get("cycles")
    return addon is not None and addon.preferences.compute_device_type in ("NONE", "OPTIX")
