"""Properties of a material for its node's sockets, with names, ranges and tooltips from the models' parameters.

The sockets alone store the values: the properties read and write them. So no value is stored twice, and links, drivers,
keyframes and undo are those of the sockets.
"""
import math

import bpy

from ...models import MODELS
from .. import backend as backends
from ..material import driven, groups, materials, sockets
from . import icons

# End of an exponent's slider. Sliders are linear, and one up to 100000 would skip all exponents below a mirror's.
_EXPONENT_SOFT_MAX = 1000.0


def _owner(group, parameter):
    """The Plausible node of the property group's material; None where it lacks the parameter or its socket."""
    node = groups.find_node(group.id_data)
    model = groups.model_of(node) if node else None
    has_it = model is not None and parameter in model.parameters and sockets.socket_of(node, parameter) is not None
    return node if has_it else None


def _clamp_number(parameter, number):
    """Clamps to [minimum, maximum] of the parameter."""
    return min(max(number, parameter.minimum), parameter.maximum)


def _clamped(parameter, value):
    """`value` clamped to the parameter's range, as by a slider; a path as an absolute path."""
    if parameter.kind in ("color", "vector"):
        return tuple(_clamp_number(parameter, number) for number in value)
    if parameter.kind == "image":
        return bpy.path.abspath(value)  # a path relative to the .blend has no meaning outside Blender
    return value if parameter.kind == "bool" else _clamp_number(parameter, value)


def _accessors(parameter):
    """The functions `get` and `set` of a parameter's property, by keyword."""
    def read(self):
        node = _owner(self, parameter)
        return parameter.default if node is None else sockets.get_value(node, parameter)

    def write(self, value):
        node = _owner(self, parameter)
        if node is None:
            raise ValueError(f"{self.id_data.name}: this material has no parameter {parameter.id!r}")
        materials.set_value(node, parameter, _clamped(parameter, value))

    return {"get": read, "set": write}


def _float_range(parameter):
    """The keywords `min` and `max` of a float property, where they are finite."""
    keys = {"min": parameter.minimum, "max": parameter.maximum}
    return {key: value for key, value in keys.items() if math.isfinite(value)}


def _property(parameter):
    """The Blender property of one parameter. Raises ValueError for an unknown kind."""
    # Not animatable: keyframes and drivers belong on the socket, which stores the value.
    common = {"name": parameter.label, "description": parameter.help, "options": set(), **_accessors(parameter)}
    if parameter.kind == "bool":
        return bpy.props.BoolProperty(**common)
    if parameter.kind == "image":
        # Since Blender 4.5 paths that begin with // need an option. `_clamped` makes such a path absolute.
        options = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5) else set()
        return bpy.props.StringProperty(subtype="FILE_PATH", **{**common, "options": options})
    if parameter.kind == "int":
        return bpy.props.IntProperty(min=int(parameter.minimum), max=int(parameter.maximum), **common)
    if parameter.kind == "enum":
        return bpy.props.EnumProperty(items=[(*item, i) for i, item in enumerate(parameter.items)], **common)
    if parameter.kind == "vector":
        return bpy.props.FloatVectorProperty(size=3, subtype="XYZ", **_float_range(parameter), **common)
    if parameter.kind == "color":
        # Only reflectances are shown as a color; a refractive index is three numbers.
        subtype = "COLOR" if parameter.maximum <= 1.0 else "NONE"
        return bpy.props.FloatVectorProperty(size=3, subtype=subtype, precision=3, **_float_range(parameter), **common)
    if parameter.kind != "float":
        raise ValueError(f"{parameter.id}: no property for the kind {parameter.kind!r}")
    if parameter.logarithmic:
        return bpy.props.FloatProperty(soft_max=min(_EXPONENT_SOFT_MAX, parameter.maximum), step=100, precision=2,
                                       **_float_range(parameter), **common)
    return bpy.props.FloatProperty(subtype=groups.subtype(parameter), precision=3, **_float_range(parameter), **common)


def _named_parameters():
    """{parameter: name of its property}, of all models.

    The name is the parameter's id. Where another model declares the same id differently, it is "<model id>_<id>".
    """
    names = {}
    for model in MODELS.values():
        for parameter in model.parameters:
            if parameter not in names:
                names[parameter] = f"{model.id}_{parameter.id}" if parameter.id in names.values() else parameter.id
    return names


NAMES = _named_parameters()
# {parameter: name of the property for its range}. Switches and reflectances lack one, as they have a fixed range: all
# values of a switch, and black to white.
RANGES = {p: f"{NAMES[p]}_range" for model in MODELS.values() if not backends.DEFAULT.follows_sockets(model)
          for p in model.parameters if p.can_be_driven and (p.kind == "float" or p.kind == "color" and p.maximum > 1.0)}


def _range_property(parameter):
    """The Blender property for the range that a driven parameter is baked over."""
    def read(self):
        node = _owner(self, parameter)
        return parameter.usual_range(parameter.default) if node is None else driven.range_of(node, parameter)

    def write(self, value):
        node = _owner(self, parameter)
        if node is None:
            raise ValueError(f"{self.id_data.name}: this material has no parameter {parameter.id!r}")
        least, most = sorted(_clamp_number(parameter, number) for number in value)
        if least < most:  # while a slider is dragged both may be equal for a moment
            materials.set_range(node, parameter, least, most)

    return bpy.props.FloatVectorProperty(
        name="Range", description="What the driven parameter is baked for, least and most. "
        "Values beyond count as the nearest; a shorter range is baked faster", size=2, precision=3, options=set(),
        **_float_range(parameter), get=read, set=write)


MODEL_ITEMS = [(model.id, model.label, model.description, i) for i, model in enumerate(MODELS.values())]


def _read_model(self):
    """The number of the material's model among MODELS; 0 without a model."""
    node = groups.find_node(self.id_data)
    model = groups.model_of(node) if node else None
    return list(MODELS).index(model.id) if model else 0


def _write_model(self, number):
    """Change the material's model to the one with this number among MODELS."""
    materials.change_model(self.id_data, list(MODELS)[number])


PlausibleMaterial = type("PlausibleMaterial", (bpy.types.PropertyGroup,), {
    "__doc__": "Parameters of a Plausible BRDF material, each held in its node's socket",
    "__annotations__": {
        **{name: _property(parameter) for parameter, name in NAMES.items()},
        **{name: _range_property(parameter) for parameter, name in RANGES.items()},
    },
})


def prepare():
    """Declare the property `model`, before its class is registered and after the icons of its items are loaded."""
    items = [(*item[:3], icons.icon_of(item[0]), item[3]) for item in MODEL_ITEMS]
    PlausibleMaterial.__annotations__["model"] = bpy.props.EnumProperty(
        name="Model", description="Reflectance model. Parameters that both models have are kept", items=items,
        options=set(), get=_read_model, set=_write_model)


CLASSES = (PlausibleMaterial,)


def start():
    """Add the properties to all materials."""
    bpy.types.Material.plausible_brdf = bpy.props.PointerProperty(type=PlausibleMaterial)


def stop():
    """Remove the properties. The values stay, as the sockets store them."""
    if hasattr(bpy.types.Material, "plausible_brdf"):
        del bpy.types.Material.plausible_brdf
