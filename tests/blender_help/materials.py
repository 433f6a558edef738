"""Materials of ours, their nodes and sockets, and errors planted in their shaders."""
from addon.backends.osl import definitions


def make(model_id, **parameters):
    from addon import create_material

    return create_material(model_id, **parameters)


def node_of(material):
    from addon.blender.material import groups

    return groups.find_node(material)


def sockets_of(material):
    """{parameter id: socket} of the node of ours in a material."""
    from addon.blender.material import sockets

    return sockets.by_id(node_of(material))


def use_table(material, control, path):
    """Name another file in the socket of a material that reads its tables from files."""
    from addon.blender.material import groups, sockets

    name = "table_controlled" if control else "table_plain"
    sockets.by_id(groups.find_node(material))[name].default_value = str(path)


# (hook of the shaders, what stands there instead) of errors that tests put into them.
PLANTED = {
    "a wrong lobe": ("SPOILT_TARGET(value)", "(value) * (hit.n + 3.0) / (hit.n + 2.0)"),
    "kernels four times too heavy, and only adding": ("SPOILT_KERNEL(weight)", "4.0 * abs(weight)"),
    "base lobes 2 % too bright": ("SPOILT_BASE(weight)", "1.02 * (weight)"),
}


def plant(monkeypatch, hook, value):
    """Put an error into every shader compiled from here on."""
    monkeypatch.setitem(definitions.HOOKS, hook, value)
