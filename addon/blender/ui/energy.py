"""The sub-panel "Energy": albedos as numbers, and a plot of albedos and lobes for the material's present values.

Panels are drawn at every redraw and must not compute. The panel shows the latest plot of a material. If the plot is for
other values than the node's, the panel requests a new one, which a timer makes before it redraws the areas. Plots are
Blender previews, which belong to no file: nothing is added to the .blend.
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

# Seconds from the request of a plot to its making: dragging a slider redraws more often.
PAUSE = 0.05
# Number of materials whose plots are kept.
KEPT = 12
# Limits of the side of each half of the plot, in units of 20 pixels, about the height of a button.
SMALLEST, LARGEST = 6.5, 12.0
# Legends of the lobes, by the root that the plot takes of f N·L.
ROOTS = {1: "Lobes f N·L, with their peaks in 1/sr", 2: "Lobes f N·L by their square root, with their peaks in 1/sr",
         3: "Lobes f N·L by their cube root, with their peaks in 1/sr"}


@dataclass
class Shown:
    """A material's plot, or the error message in its place, for the values of `key`, see `key_of`.

    `halves` are the previews of the left and the right half of the picture.
    """

    key: tuple
    plot: quick.Plot | None
    error: str
    halves: tuple


_shown = {}  # full name of a material -> Shown, the latest at the end
_wanted = {}  # requests: full name of a material -> (key, model, values)
_previews = None  # Blender's collection of previews


def key_of(model, given: dict) -> tuple:
    """The inputs of a plot: the model's id, the values `given` by parameter id, and the stamps of their files."""
    stamps = tuple(p.stamp(given[p.id]) for p in model.parameters if p.id in given)
    return model.id, tuple(given.items()), stamps


def known(material, model, given: dict):
    """The latest `Shown` of a material, for the values `given` or for earlier ones; None if there is none yet.

    Requests the plot of the values `given` if it is for other values.
    """
    name, key = material.name_full, key_of(model, given)
    latest = _shown.get(name)
    if latest is None or latest.key != key:
        _wanted[name] = key, model, given
        if not bpy.app.timers.is_registered(make_wanted):
            bpy.app.timers.register(make_wanted, first_interval=PAUSE)
    return latest


def make_wanted():
    """Make the requested plots, and redraw the panels."""
    while _wanted:
        name, (key, model, given) = _wanted.popitem()
        plot, error = None, ""
        try:
            plot = quick.plot(model, given)
        except (ValueError, OSError) as problem:  # an image or an albedo table that cannot be read
            error = str(problem)
        # Draw into the material's previews.
        halves = _halves(name)
        if plot is not None:
            _fill(halves, picture.draw(plot))
        _shown[name] = Shown(key, plot, error, halves)
    redraw()


def _halves(name):
    """The two previews of a material: its own, else the oldest material's where KEPT have some, else new ones."""
    global _previews
    if name in _shown:
        return _shown.pop(name).halves
    if len(_shown) >= KEPT:
        return _shown.pop(next(iter(_shown))).halves
    if _previews is None:
        _previews = bpy.utils.previews.new()
    return tuple(_previews.new(f"{len(_previews)}") for _ in range(2))


def _fill(halves, pixels):
    """Write the two halves of the picture `pixels` (SIDE, 2 SIDE, 4) into previews."""
    side = picture.SIDE
    for i, half in enumerate(halves):
        half.image_size = side, side
        half.image_pixels_float.foreach_set(np.ascontiguousarray(pixels[:, i * side:(i + 1) * side]).ravel())


def stop():
    """Drop all plots, and remove the timer and the previews."""
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
        shown = known(material, model, values(node))
        if shown is None:
            layout.label(text="Computing", icon="TIME")
        elif shown.error:
            draw_text(layout, context, shown.error, "ERROR")
        else:
            draw_plot(layout, context, shown)
        for line in driven_lines(node, model):
            draw_text(layout, context, line, "LINKED")


def draw_plot(layout, context, shown: Shown):
    """Draw the numbers, the picture and its legend."""
    draw_numbers(layout, shown.plot.numbers())
    draw_text_above_one(layout, context, shown.plot)
    # An icon is a square of `scale` times 20 pixels. The halves stand side by side if the region is wide enough.
    width = (context.region.width / context.preferences.system.ui_scale - 60.0) / 20.0
    side_by_side = width > 2 * SMALLEST
    both = layout.row() if side_by_side else layout.column()
    both.alignment = "CENTER"
    scale = min(max(0.5 * width if side_by_side else width, SMALLEST), LARGEST)
    for half in shown.halves:
        both.template_icon(icon_value=half.icon_id, scale=scale)
    # The legend.
    note = layout.column()
    note.active = False
    draw_text(note, context, legend(shown.plot))


def draw_numbers(layout, numbers: dict):
    """Draw `numbers`, {view in degrees: albedo (1,) or (3,)}."""
    # One row where all albedos are gray, else a row for each view.
    column = layout.column(align=True)
    if all(len(albedo) == 1 for albedo in numbers.values()):
        row = column.row()
        for view, albedo in numbers.items():
            row.label(text=f"{view:g}°:  {albedo[0]:.3f}")
        return
    for view, albedo in numbers.items():
        row = column.row()
        row.label(text=f"{view:g}°")
        for letter, channel in zip("RGB", albedo, strict=True):
            row.label(text=f"{letter} {channel:.3f}")


def draw_text_above_one(layout, context, plot):
    """Draw a warning where an albedo exceeds 1."""
    highest = np.nan_to_num(plot.albedo).max(axis=1)
    if highest.max() > 1.0 + quick.TOLERANCE:
        view, most = quick.VIEWS[highest.argmax()], highest.max()
        draw_text(layout, context, tr(
            "Gives more light than it gets: {times:.3g} times at {view:.3g}°", times=most, view=view), "ERROR")


def legend(plot) -> str:
    """The legend of the picture."""
    sentences = ["Albedo by the angle of the view, gray before pumping" if plot.unpumped is not None else
                 "Albedo by the angle of the view", ROOTS[picture.power_of(plot)]]
    if plot.along_tangent:
        sentences.append("Seen along the tangent")
    return ". ".join(map(tr, sentences))


def driven_lines(node, model) -> list:
    """A line for each linked parameter: the plot uses the value of its socket."""
    lines = []
    for parameter in model.parameters:
        socket = socket_of(node, parameter)
        if parameter.evaluated and socket is not None and socket.is_linked:
            source = socket.links[0].from_node
            lines.append(tr("{parameter} is driven by {node}: plotted for the value of its socket",
                             parameter=tr(parameter.label), node=source.label or source.name))
    return lines


CLASSES = in_both_places((_Energy,))
