"""The sub-panel "Energy": albedos as numbers, and a picture of them and of the lobes that follows the values.

A panel is drawn at every redraw and must not compute. It shows what is known of a material; where that is of other
values than the node holds, it asks for a plot, which a timer makes before the areas are drawn again. Pictures are
previews, which belong to no file: nothing is made in the .blend.
"""
from dataclasses import dataclass

import bpy
import bpy.utils.previews
import numpy as np

from ...plots import picture, quick
from ..host.redraw import redraw
from ..host.translation import tr
from ..material.sockets import socket_of, values
from .panels import Face, draw_text, in_both_places

PAUSE = 0.05  # seconds from a redraw to the plot that it asks for: a slider that is dragged redraws more often
KEPT = 12  # materials whose plots are kept
SMALLEST, LARGEST = 6.5, 12.0  # side of a half of the picture in units of 20 pixels, which are about a button
ROOTS = {1: "Lobes f N·L, with their peaks in 1/sr", 2: "Lobes f N·L by their square root, with their peaks in 1/sr",
         3: "Lobes f N·L by their cube root, with their peaks in 1/sr"}


@dataclass
class Shown:
    """What is known of a material: a `plot`, or the `error` why there is none, for what `key` stands for.

    `halves` are the previews of the picture's left and right.
    """

    key: tuple
    plot: quick.Plot | None
    error: str
    halves: tuple


_shown = {}  # a material's full name -> Shown, the one asked for last at the end
_wanted = {}  # a material's full name -> (key, model, values)
_previews = None


def key_of(model, given: dict) -> tuple:
    """What a plot depends on: the model, the values of its parameters, and the state of the files that they name."""
    stamps = tuple(p.stamp(given[p.id]) for p in model.parameters if p.id in given)
    return model.id, tuple(given.items()), stamps


def known(material, model, given: dict):
    """What is known of a material, of these values or of earlier ones; None before anything is.

    Asks for the plot of these values where it is not that.
    """
    name, key = material.name_full, key_of(model, given)
    found = _shown.get(name)
    if found is None or found.key != key:
        _wanted[name] = key, model, given
        if not bpy.app.timers.is_registered(make_wanted):
            bpy.app.timers.register(make_wanted, first_interval=PAUSE)
    return found


def make_wanted():
    """Make the plots that were asked for, and have the panels drawn again."""
    while _wanted:
        name, (key, model, given) = _wanted.popitem()
        plot, error = None, ""
        try:
            plot = quick.plot(model, given)
        except (ValueError, OSError) as problem:  # an image or a table that cannot be read
            error = str(problem)
        halves = _halves(name)
        if plot is not None:
            _fill(halves, picture.draw(plot))
        _shown[name] = Shown(key, plot, error, halves)
    redraw()


def _halves(name):
    """The two previews of a material: its own, those of one that was not asked for in a long time, or new ones."""
    global _previews
    if name in _shown:
        return _shown.pop(name).halves
    if len(_shown) >= KEPT:
        return _shown.pop(next(iter(_shown))).halves
    if _previews is None:
        _previews = bpy.utils.previews.new()
    return tuple(_previews.new(f"{len(_previews)}") for _ in range(2))


def _fill(halves, pixels):
    side = picture.SIDE
    for i, half in enumerate(halves):
        half.image_size = side, side
        half.image_pixels_float.foreach_set(np.ascontiguousarray(pixels[:, i * side:(i + 1) * side]).ravel())


def stop():
    """Forget all plots, and take back the timer and the previews."""
    global _previews
    if bpy.app.timers.is_registered(make_wanted):
        bpy.app.timers.unregister(make_wanted)
    _wanted.clear()
    _shown.clear()
    if _previews is not None:
        bpy.utils.previews.remove(_previews)
        _previews = None


class _Energy(Face):
    bl_label = "Energy"

    def draw(self, context):
        layout, material, node, model = self.begin(context)
        found = known(material, model, values(node))
        if found is None:
            layout.label(text="Computing", icon="TIME")
        elif found.error:
            draw_text(layout, context, found.error, "ERROR")
        else:
            draw_plot(layout, context, found)
        for line in driven_lines(node, model):
            draw_text(layout, context, line, "LINKED")


def draw_plot(layout, context, shown: Shown):
    """The numbers, the picture, and what to know of it."""
    draw_numbers(layout, shown.plot.numbers())
    draw_text_above_one(layout, context, shown.plot)
    # An icon is a square of `scale` times 20 pixels. Two stand side by side where they are large enough to be read.
    width = (context.region.width / context.preferences.system.ui_scale - 60.0) / 20.0
    beside = width > 2 * SMALLEST
    both = layout.row() if beside else layout.column()
    both.alignment = "CENTER"
    for half in shown.halves:
        both.template_icon(icon_value=half.icon_id, scale=min(max(0.5 * width if beside else width, SMALLEST), LARGEST))
    note = layout.column()
    note.active = False
    draw_text(note, context, legend(shown.plot))


def draw_numbers(layout, numbers: dict):
    """The albedos (1,) or (3,) of each view in degrees."""
    column = layout.column(align=True)
    if all(len(albedo) == 1 for albedo in numbers.values()):
        row = column.row()
        for view, albedo in numbers.items():
            row.label(text=f"{view:g}°:  {albedo[0]:.3f}")
        return
    for view, albedo in numbers.items():
        row = column.row()
        row.label(text=f"{view:g}°")
        for letter, part in zip("RGB", albedo, strict=True):
            row.label(text=f"{letter} {part:.3f}")


def draw_text_above_one(layout, context, plot):
    """A word where the model reflects more than it receives."""
    highest = np.nan_to_num(plot.albedo).max(axis=1)
    if highest.max() > 1.0 + quick.TOLERANCE:
        view, most = quick.VIEWS[highest.argmax()], highest.max()
        draw_text(layout, context, tr(
            "Gives more light than it gets: {times:.3g} times at {view:.3g}°", times=most, view=view), "ERROR")


def legend(plot) -> str:
    """What the picture shows, in words."""
    parts = ["Albedo by the angle of the view, gray before pumping" if plot.unpumped is not None else
             "Albedo by the angle of the view", ROOTS[picture.power_of(plot)]]
    if plot.along_tangent:
        parts.append("Seen along the tangent")
    return ". ".join(map(tr, parts))


def driven_lines(node, model) -> list:
    """A line for each parameter that a link drives: what it is plotted for."""
    lines = []
    for parameter in model.parameters:
        socket = socket_of(node, parameter)
        if parameter.evaluated and socket is not None and socket.is_linked:
            source = socket.links[0].from_node
            lines.append(tr("{parameter} is driven by {node}: plotted for the value of its socket",
                             parameter=tr(parameter.label), node=source.label or source.name))
    return lines


CLASSES = in_both_places((_Energy,))
