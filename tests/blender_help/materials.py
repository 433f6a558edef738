"""Materials of ours, their nodes and sockets, and errors planted in their shaders."""
import re

from addon.shading import source


def make(model_id, **parameters):
    from addon import create_material

    return create_material(model_id, **parameters)


def node_of(material):
    from addon.blender import materials

    return materials.find_node(material)


def sockets_of(material):
    """{parameter id: socket} of the node of ours in a material."""
    from addon.blender import groups

    return groups.sockets(node_of(material))


def use_table(material, control, path):
    """Name another file in the socket of a material that reads its tables from files."""
    from addon.blender import groups, nodes

    name = "table_controlled" if control else "table_plain"
    groups.sockets(nodes.find_node(material))[name].default_value = str(path)


# (pattern, replacement) of errors that tests put into shaders.
PLANTED = {
    "a wrong lobe": (r"(float lobe_value\([^}]*?)\(n \+ 2\.0\)", r"\1(n + 3.0)"),
    "splats four times too heavy, and only adding": (r"(color weight = )(clamp\(left[^)]*\))", r"\g<1>4.0 * abs(\2)"),
    "base lobes 2 % too bright": (r"(sum \+= )(weight \* tint)", r"\g<1>1.02 * \2"),
}


def plant(monkeypatch, pattern, replacement):
    """Put an error into every shader compiled from here on."""
    right = source.assemble

    def wrong(*arguments):
        text, count = re.subn(pattern, replacement, right(*arguments), flags=re.DOTALL)
        assert count, "the shader has changed: the planted error is not in it"
        return text

    monkeypatch.setattr(source, "assemble", wrong)
