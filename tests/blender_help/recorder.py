"""A layout for drawing a panel without a window, and a context for the panel.

Blender draws no panel without a window, and makes no layout for a script. The recorder replaces the layout: it rejects
every call, argument, property, icon and operator that the running Blender's own UILayout rejects.
"""
from types import SimpleNamespace


class Recorder:
    """A layout that checks each call against UILayout's own description, and appends (function, arguments) to `log`."""

    def __init__(self, log):
        object.__setattr__(self, "log", log)

    def __setattr__(self, name, value):
        import bpy

        declared = bpy.types.UILayout.bl_rna.properties[name]
        assert not declared.is_readonly, f"layout.{name} is read-only"
        assert declared.type != "ENUM" or value in declared.enum_items, f"layout.{name} = {value!r}"

    def __getattr__(self, name):
        import bpy

        declared = bpy.types.UILayout.bl_rna.functions[name]

        def call(*args, **kwargs):
            inputs = [p for p in declared.parameters if not p.is_output]
            arguments = dict(zip((p.identifier for p in inputs), args, strict=False)) | kwargs
            accepted = {p.identifier: p for p in inputs}
            unknown = set(arguments) - set(accepted)
            assert not unknown, f"layout.{name}() takes no {unknown}"
            missing = {p.identifier for p in inputs if p.is_required} - set(arguments)
            assert not missing, f"layout.{name}() needs {missing}"
            _check_arguments(name, arguments, accepted)
            self.log.append((name, arguments))
            if name == "operator":
                return Button(arguments["operator"])
            return Recorder(self.log) if name in ("row", "column", "box", "split") else None

        return call


class Button:
    """The result of layout.operator(): it accepts the operator's own properties only."""

    def __init__(self, operator):
        object.__setattr__(self, "_rna", _operator_rna(operator))

    def __setattr__(self, name, value):
        # The type is a generic one for the properties that Blender's own Python operators declare.
        assert name in self._rna.properties, f"{self._rna.identifier} has no property {name}"
        items = getattr(self._rna.properties[name], "enum_items", None)
        chosen = value if isinstance(value, set) else {value}
        assert not items or chosen <= set(items.keys()), f"{self._rna.identifier}.{name} = {value!r}"


def _operator_rna(name):
    import bpy

    module, _, function = name.partition(".")
    assert function in dir(getattr(bpy.ops, module)), f"no operator {name}"
    return getattr(getattr(bpy.ops, module), function).get_rna_type()


def _check_arguments(name, arguments, accepted):
    import bpy

    for key, value in arguments.items():
        if accepted[key].type == "ENUM":
            assert value in accepted[key].enum_items, f"layout.{name}({key}={value!r})"
        if accepted[key].type == "STRING":
            assert isinstance(value, str), f"layout.{name}({key}={value!r})"
    if name == "prop":
        assert arguments["property"] in arguments["data"].bl_rna.properties, arguments
        getattr(arguments["data"], arguments["property"])
    if name == "menu":
        assert issubclass(getattr(bpy.types, arguments["menu"]), bpy.types.Menu)
    if name == "operator":
        _operator_rna(arguments["operator"])


def context_for(bpy, material=None, engine="CYCLES", osl=True, space=None, device="CPU"):
    """A context with a material tab, with the attributes that the panels read."""
    cycles = SimpleNamespace(shading_system=osl, device=device)
    scene = SimpleNamespace(render=SimpleNamespace(engine=engine), cycles=cycles)
    return SimpleNamespace(
        scene=scene, engine=engine, material=material, object=None, region=SimpleNamespace(width=400),
        space_data=space or SimpleNamespace(type="PROPERTIES"),
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)),
    )


def shader_editor(material):
    """The space of a shader editor that shows a material."""
    return SimpleNamespace(type="NODE_EDITOR", tree_type="ShaderNodeTree", shader_type="OBJECT", id=material)


def drawn(context, prefix="PLAUSIBLE_PT_"):
    """Draws the panels whose poll succeeds; returns a list of (layout function, its arguments)."""
    from addon.blender.ui.panels import CLASSES

    log = []
    in_editor = context.space_data.type == "NODE_EDITOR"
    for cls in CLASSES:
        if (cls.bl_space_type == "NODE_EDITOR") == in_editor and cls.poll(context):
            stand_in = type(cls.__name__, cls.__bases__[:-1], {})()  # a Panel itself cannot be made by a script
            stand_in.layout = Recorder(log)
            cls.draw(stand_in, context)
    return log


def properties(log):
    """Names of the properties drawn."""
    return [arguments["property"] for name, arguments in log if name == "prop"]


def texts(log):
    """The labels' texts in one string."""
    return " ".join(arguments.get("text", "") for name, arguments in log if name == "label")


def operators(log):
    """Ids of the operators drawn."""
    return [arguments["operator"] for name, arguments in log if name == "operator"]
