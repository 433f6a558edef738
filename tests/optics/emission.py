"""What goes on inside a shader, made visible: its numbers rendered as emission, one sample a pixel or many.

A pixel of one sample holds the numbers of one hit, in single precision; one of many their mean.
"""
from pathlib import Path

import numpy as np

from addon.backends.osl import constants, definitions
from addon.measure import scene, standards
from optics.directions import toward

INCLUDE = Path(__file__).resolve().parents[2] / "osl" / "include"
BROAD = 2e4  # meters: the side of the room's plane


def headers(*names, **hooks):
    """The text of headers that include no other, with the macros that they expect; `hooks` by the macro's name."""
    macros = {name: hooks.pop(name.partition("(")[0], value) for name, value in definitions.HOOKS.items()}
    assert not hooks, f"no hooks {hooks}"
    own = "".join((INCLUDE / name).read_text(encoding="utf-8") for name in names)
    return constants.header() + definitions.text(macros) + own


def material(text, color, before="", rest=""):
    """A material that emits the OSL expression `color` after the statements `before`, and the closures `rest`."""
    body = f"{before} BSDF = color({color}) * emission() {rest};"
    return standards.material_of_source(f"{text}\nshader shown(output closure color BSDF = 0) {{ {body} }}\n", "Shown")


class Square(scene.MeasuringScene):
    """A room whose plane is a square of `side` meters, far from the origin by `away` along all axes.

    `width` meters of it are seen, `view_deg` from its normal and `azimuth_deg` from its tangent, through a pixel filter
    of `pixels` wide; `turned(place)` changes what else there is.
    """

    def __init__(self, subject, resolution, side=4.0, away=0.0, view_deg=0.0, azimuth_deg=0.0, width=1.0, pixels=1.5,
                 turned=None):
        super().__init__(subject, scene.PLANE, resolution)
        self.look_from(toward(view_deg, azimuth_deg), width)
        self.scene.cycles.filter_width = pixels
        for corner in self.scene.objects["Plausible Subject"].data.vertices:
            corner.co *= side / BROAD
        if turned:
            turned(self)
        for thing in self.scene.objects:
            thing.location = [place + away for place in thing.location]


def shown(subject, resolution=1000, samples=1, seed=0, rows=None, **scene):
    """The picture (resolution, resolution, 3) of a `Square`, or its lowest `rows` alone, the same pixels."""
    with Square(subject, resolution, **scene) as place:
        if rows:
            place.scene.render.use_border, place.scene.render.border_max_y = True, rows / resolution
        return place.render(samples, seed)[:rows]


def perspective(place):
    """A lens of 50 degrees, as far as it sees about as much."""
    place.scene.camera.data.type = "PERSP"
    place.scene.camera.data.angle = 2.0 * np.arctan(0.5 * place.scene.camera.data.ortho_scale / 10.0)
