"""The page of a model and the index of all, in Markdown: what the registry declares and what its formula computes."""
import math
import textwrap

from ... import brdf
from ...backends.osl import estimator
from ...forms.albedo import tabulated
from ...library.presets import PRESETS
from ...models.pumped_model import PumpedModel
from ..compare import properties
from .figure_values import shown
from .limits import limits_of, made_of_lumps

INDEX = "README.md"
_WIDTH = 120
_MADE_BY = "<!-- Made by `plausible docs` from the registry: edit what is declared there. -->"
# Heading, what stands below it, and which models are under it: each under one.
_GROUPS = (
    ("Phong and Blinn", "After Neumann, Neumann and Szirmay-Kalos: with shaders of their own.",
     lambda model: not estimator.is_baked(model) and not made_of_lumps(model)),
    ("Lumps on the halfway vector disk", "After Edwards et al.: with shaders of their own.", made_of_lumps),
    ("Models of the literature", "Formulas in NumPy, baked for the values of their parameters.",
     lambda model: estimator.is_baked(model) and not isinstance(model, PumpedModel)),
    ("Models of the literature, pumped up", "Divided by their own albedo, and baked for the values of parameters.",
     lambda model: isinstance(model, PumpedModel)),
)


def file_name(model) -> str:
    """Name of a model's page in its folder."""
    return f"{model.id}.md"


def picture_name(model) -> str:
    """Name of the picture beside the page."""
    return f"{model.id}.png"


def page(model) -> str:
    """The page of a model."""
    parts = [_MADE_BY, f"# {model.label}", f"{model.description}.", _picture(model), "## Formula",
             f"```text\nf(V, L) = {model.formula}\n```",
             "Symbols are those of [README, Models](../../README.md#models).", "## Parameters", _parameters(model),
             "## Properties", "Computed from the formula, all parameters at their defaults.", _properties(model),
             "## In Blender", _rendered(model), _calls(model)]
    presets = [preset for preset in PRESETS.values() if preset.model == model.id]
    if presets:
        parts += ["## Presets", "\n".join(f"- **{each.label}** ({each.group}): {each.help}" for each in presets)]
    parts += ["## Limits", *_limits(model), "## Sources", "\n".join(f"- {source}" for source in model.references),
              f"[All models]({INDEX})"]
    return "\n\n".join(parts) + "\n"


def index() -> str:
    """The index of the models' pages."""
    parts = [_MADE_BY, "# Models", _wrapped(
        f"{len(brdf.MODELS)} models, each with a page: formula, parameters, what it is like, limits and sources. "
        "`plausible list` prints the same, `plausible compare` holds the models against each other, and "
        "[For researchers](../researchers.md) tells how to add one.")]
    for heading, text, is_here in _GROUPS:
        models = [model for model in brdf.MODELS.values() if is_here(model)]
        rows = [f'| <img src="{picture_name(m)}" width="330" alt="{m.label}"> | [{m.label}]({file_name(m)})<br>'
                f"`{m.id}` | {_cell(m.description)} |" for m in models]
        parts += [f"## {heading}", text, "\n".join(["| | Model | |", "|---|---|---|", *rows])]
    return "\n\n".join(parts) + "\n"


def _picture(model):
    this = shown(model)
    values = ", ".join(f"{value:g}" for value in this.values)
    others = "".join(f", {model.parameter(name).label} {_value(model.parameter(name), value)}"
                     for name, value in this.others.items())
    caption = (f"*{this.parameter.label} {values}{others}: balls under a sun six degrees wide and a sky, rendered in "
               "Cycles; albedo by the angle of the view; f over its peak in the plane of incidence"
               f"{', across the tangent' * this.is_across}, the light at 45°.*")
    return f"![{model.label}: {this.parameter.label} {values}]({picture_name(model)})\n\n{_wrapped(caption)}"


def _parameters(model):
    units = any(p.unit for p in model.parameters)
    head = ["Name", "Identifier", "Range", "Default", *(["Unit"] if units else []), "What it is"]
    rows = [[p.label, f"`{p.id}`", _range(p), _value(p, p.default), *([p.unit] if units else []), _help(p)]
            for p in model.parameters]
    lines = ["| " + " | ".join(_cell(text) for text in row) + " |" for row in [head, *rows]]
    return "\n".join([lines[0], "|" + "---|" * len(head), *lines[1:]])


def _range(parameter):
    if parameter.kind == "bool":
        return "on, off"
    if parameter.kind == "enum":
        return ", ".join(f"`{item[0]}`" for item in parameter.items)
    if parameter.kind == "image":
        return "a file"
    if not math.isfinite(parameter.maximum):
        return "a direction"
    span = f"{parameter.minimum:g} to {parameter.maximum:g}"
    return f"{span}, each of R, G, B" if parameter.kind == "color" else span


def _value(parameter, value):
    """A value as it stands in a table."""
    if parameter.kind == "bool":
        return "on" if value else "off"
    if parameter.kind == "enum":
        return f"`{parameter.items[value][0]}`"
    if parameter.kind == "image":
        return value or "none"
    if parameter.kind == "vector":
        return "unlinked"
    return ", ".join(f"{c:g}" for c in value) if parameter.kind == "color" else f"{value:g}"


def _help(parameter):
    choices = "; ".join(f"`{name}`: {text[0].lower()}{text[1:]}" for name, _, text in parameter.items)
    return parameter.help + (f". {choices}" if choices else "")


def _properties(model):
    """What `plausible compare` computes of the formula, in words; not what is a machine's, as time."""
    error = properties.reciprocity_error(model, {})
    largest, angle = properties.largest_albedo(model, {})
    spike, gain = properties.spike(model, {}), properties.fresnel(model, {})
    peaks = [_peak(properties.off_specular(model, {}, light), light) for light in properties.OFF_SPECULAR_ANGLES]
    angles = ", ".join(f"{light:g}" for light in properties.OFF_SPECULAR_ANGLES)
    conserves = largest <= 1.0 + properties.QUADRATURE_ERROR
    rows = [
        ("Reciprocal", "yes" if error < 1e-6 else f"no: f(V, L) and f(L, V) differ by up to {100.0 * error:.0f} %"),
        ("Conserves energy", f"{'yes' if conserves else 'no'}: the largest albedo is {largest:.3f}, at {angle:g}°"),
        (f"Peak off the mirror direction, towards grazing, light at {angles}°", ", ".join(peaks)),
        ("Fresnel", f"a colour of 4 % grows {gain:.1f} times to 85°" if gain > 1.0 + 1e-6 else
         "the colour is the same at every angle"),
        ("Anisotropic", "yes" if properties.anisotropy(model, {}) > 1e-3 else "no"),
        ("Diffuse part", properties.diffuse(model, {})),
    ]
    if spike > 1e-6:
        rows.append(("Mirror on top of f", f"reflects up to {spike:.2f}"))
    return "\n".join(["| | |", "|---|---|", *(f"| {name} | {text} |" for name, text in rows)])


def _peak(shift, light):
    if shift is None:
        return "grows without bound to the horizon"
    if light + shift > 89.99:
        return "at the horizon"
    return f"{shift:+.1f}°" if abs(shift) > 0.06 else "none"


def _rendered(model):
    if estimator.is_baked(model):
        return _wrapped(
            "It is baked: for the values of its parameters, in seconds, into weights that the material carries. A "
            "material whose values are not those of its weights renders striped; the panel bakes anew when values have "
            "rested. What is linked, driven or keyframed is baked over a range, in steps. Directions and what is under "
            "*Sampling* follow links without that.")
    words = "It has a shader of its own: every parameter may be linked, driven and keyframed."
    if tabulated.tables_of(model):
        names = ", ".join(f"`{name}`" for name in tabulated.tables_of(model))
        words += f" It reads the albedo tables {names}, which are compiled into the material."
    return _wrapped(words)


def _calls(model):
    this = shown(model)
    name, value = this.parameter.id, this.values[1]
    return "\n".join(["```python", "from addon import brdf, create_material", "",
                      f'material = create_material("{model.id}", {name}={value:g})  # in Blender',
                      "# In NumPy, seen at 0 and at 60 degrees:",
                      f'albedo = brdf.MODELS["{model.id}"].albedo([1.0, 0.5], {name}={value:g})', "```", "", "```sh",
                      f"plausible furnace {model.id} --set {name}={value:g}",
                      f"plausible goniometer {model.id} --set {name}={value:g} --view 40", "```"])


def _limits(model):
    own = "\n".join(f"- {entry}" for entry in limits_of(model))  # one line each: none can begin with a > or a number
    return [*([own] if own else []), "What holds for all models: [README, Limits](../../README.md#limits)."]


def _cell(text):
    return text.replace("|", "\\|")


def _wrapped(text):
    return textwrap.fill(text, _WIDTH, break_long_words=False, break_on_hyphens=False)
