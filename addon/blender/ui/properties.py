"""Properties of a material that show its node's sockets with names, ranges and help from the registry.

A value lives in its socket only: these properties read and write there, so nothing is stored twice and links, drivers,
keyframes and undo are the socket's own.
"""
import math

import bpy

from ...models import MODELS
from .. import backend as backends
from ..material import driven, groups, materials, sockets
from . import icons

_EXPONENT_SOFT_MAX = 1000.0  # dragging is linear: to 100000 it would jump over everything that is not a mirror


def _owner(group, parameter):
    """The node of the group's material, if it has the parameter; else None."""
    node = groups.find_node(group.id_data)
    model = groups.model_of(node) if node else None
    known = model is not None and parameter in model.parameters and sockets.socket_of(node, parameter) is not None
    return node if known else None


def _hold(parameter, number):
    return min(max(number, parameter.minimum), parameter.maximum)


def _held(parameter, value):
    """`value` held to the parameter's range, as a slider does."""
    if parameter.kind in ("color", "vector"):
        return tuple(_hold(parameter, number) for number in value)
    if parameter.kind == "image":
        return bpy.path.abspath(value)  # what is relative to the .blend means nothing outside Blender
    return value if parameter.kind == "bool" else _hold(parameter, value)


def _accessors(parameter):
    def read(self):
        node = _owner(self, parameter)
        return parameter.default if node is None else sockets.get_value(node, parameter)

    def write(self, value):
        node = _owner(self, parameter)
        if node is None:
            raise ValueError(f"{self.id_data.name}: this material has no parameter {parameter.id!r}")
        materials.set_value(node, parameter, _held(parameter, value))

    return {"get": read, "set": write}


def _float_range(parameter):
    keys = {"min": parameter.minimum, "max": parameter.maximum}
    return {key: value for key, value in keys.items() if math.isfinite(value)}


def _property(parameter):
    """The Blender property of one parameter. Raises ValueError for a kind that has none."""
    # Not animatable: keyframes and drivers belong on the socket, which holds the value.
    common = {"name": parameter.label, "description": parameter.help, "options": set(), **_accessors(parameter)}
    if parameter.kind == "bool":
        return bpy.props.BoolProperty(**common)
    if parameter.kind == "image":
        # 4.5 and later ask whether a path may begin with //; ours is made whole when it is written.
        options = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5) else set()
        return bpy.props.StringProperty(subtype="FILE_PATH", **{**common, "options": options})
    if parameter.kind == "int":
        return bpy.props.IntProperty(min=int(parameter.minimum), max=int(parameter.maximum), **common)
    if parameter.kind == "enum":
        return bpy.props.EnumProperty(items=[(*item, i) for i, item in enumerate(parameter.items)], **common)
    if parameter.kind == "vector":
        return bpy.props.FloatVectorProperty(size=3, subtype="XYZ", **_float_range(parameter), **common)
    if parameter.kind == "color":
        # Only reflectances are colours to look at; a refractive index is three numbers.
        subtype = "COLOR" if parameter.maximum <= 1.0 else "NONE"
        return bpy.props.FloatVectorProperty(size=3, subtype=subtype, precision=3, **_float_range(parameter), **common)
    if parameter.kind != "float":
        raise ValueError(f"{parameter.id}: no property for the kind {parameter.kind!r}")
    if parameter.logarithmic:
        return bpy.props.FloatProperty(soft_max=min(_EXPONENT_SOFT_MAX, parameter.maximum), step=100, precision=2,
                                       **_float_range(parameter), **common)
    return bpy.props.FloatProperty(subtype=groups.subtype(parameter), precision=3, **_float_range(parameter), **common)


def _named_parameters():
    """Property name of every parameter of every model: its id, unless models declare one id differently."""
    names = {}
    for model in MODELS.values():
        for parameter in model.parameters:
            if parameter not in names:
                names[parameter] = f"{model.id}_{parameter.id}" if parameter.id in names.values() else parameter.id
    return names


NAMES = _named_parameters()
# Property name of the range of each parameter that has one: switches have all their values, colours go from black to
# white.
RANGES = {p: f"{NAMES[p]}_range" for model in MODELS.values() if not backends.DEFAULT.follows_sockets(model)
          for p in model.parameters if p.can_be_driven and (p.kind == "float" or p.kind == "color" and p.maximum > 1.0)}


def _range_property(parameter):
    """The property for the range that a parameter is baked over where it is driven."""
    def read(self):
        node = _owner(self, parameter)
        return parameter.usual_range(parameter.default) if node is None else driven.range_of(node, parameter)

    def write(self, value):
        node = _owner(self, parameter)
        if node is None:
            raise ValueError(f"{self.id_data.name}: this material has no parameter {parameter.id!r}")
        least, most = sorted(_hold(parameter, number) for number in value)
        if least < most:  # a slider may bring both together on its way
            materials.set_range(node, parameter, least, most)

    return bpy.props.FloatVectorProperty(
        name="Range", description="What the driven parameter is baked for, least and most. "
        "Values beyond count as the nearest; a shorter range is baked faster", size=2, precision=3, options=set(),
        **_float_range(parameter), get=read, set=write)


MODEL_ITEMS = [(model.id, model.label, model.description, i) for i, model in enumerate(MODELS.values())]


def _read_model(self):
    node = groups.find_node(self.id_data)
    model = groups.model_of(node) if node else None
    return list(MODELS).index(model.id) if model else 0


def _write_model(self, number):
    materials.change_model(self.id_data, list(MODELS)[number])


PlausibleMaterial = type("PlausibleMaterial", (bpy.types.PropertyGroup,), {
    "__doc__": "Parameters of a Plausible BRDF material, each held in its node's socket",
    "__annotations__": {
        **{name: _property(parameter) for parameter, name in NAMES.items()},
        **{name: _range_property(parameter) for parameter, name in RANGES.items()},
    },
})


def prepare():
    """Declare the property `model`, before its class is registered: its items' icons are those of today."""
    items = [(*item[:3], icons.icon_of(item[0]), item[3]) for item in MODEL_ITEMS]
    PlausibleMaterial.__annotations__["model"] = bpy.props.EnumProperty(
        name="Model", description="Reflectance model. Parameters that both models have are kept", items=items,
        options=set(), get=_read_model, set=_write_model)


CLASSES = (PlausibleMaterial,)


def start():
    """Give every material the properties."""
    bpy.types.Material.plausible_brdf = bpy.props.PointerProperty(type=PlausibleMaterial)


def stop():
    """Take them back; values stay, as they are the sockets'."""
    if hasattr(bpy.types.Material, "plausible_brdf"):
        del bpy.types.Material.plausible_brdf
