"""Renders a shader's inner numbers as emission, with one sample a pixel or many.

A pixel of one sample holds the numbers of one hit, in single precision; a pixel of many samples holds their mean.
"""
from pathlib import Path

import numpy as np

from addon.backends.osl import constants, definitions
from addon.measure import scene, standards
from optics.directions import toward

INCLUDE = Path(__file__).resolve().parents[2] / "osl" / "include"
BROAD = 2e4  # meters: the side of the plane of a MeasuringScene


def headers(*names, **hooks):
    """The text of headers that include no other, with the macros that they expect.

    `hooks` replace macros, by their names.
    """
    macros = {name: hooks.pop(name.partition("(")[0], value) for name, value in definitions.HOOKS.items()}
    assert not hooks, f"no hooks {hooks}"
    included = "".join((INCLUDE / name).read_text(encoding="utf-8") for name in names)
    return constants.header() + definitions.text(macros) + included


def material(text, color, before="", rest=""):
    """A material that emits the OSL expression `color`, after the statements `before`, and adds the closures `rest`."""
    body = f"{before} BSDF = color({color}) * emission() {rest};"
    return standards.material_of_source(f"{text}\nshader shown(output closure color BSDF = 0) {{ {body} }}\n", "Shown")


class Square(scene.MeasuringScene):
    """A scene whose plane is a square of `side` meters, moved by `away` meters along all axes.

    The camera sees `width` meters of the square, from `view_deg` off its normal and `azimuth_deg` off its tangent. The
    pixel filter is `pixels` wide. `turned(stage)` changes the scene before everything is moved.
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
        for body in self.scene.objects:
            body.location = [coordinate + away for coordinate in body.location]


def shown(subject, resolution=1000, samples=1, seed=0, rows=None, **scene):
    """The picture (resolution, resolution, 3) of a `Square`, or its lowest `rows` alone, with equal pixels."""
    with Square(subject, resolution, **scene) as stage:
        if rows:
            stage.scene.render.use_border, stage.scene.render.border_max_y = True, rows / resolution
        return stage.render(samples, seed)[:rows]


def perspective(stage):
    """Replaces the orthographic camera by a perspective one that sees about the same width, 10 meters away."""
    stage.scene.camera.data.type = "PERSP"
    stage.scene.camera.data.angle = 2.0 * np.arctan(0.5 * stage.scene.camera.data.ortho_scale / 10.0)
