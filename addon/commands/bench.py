"""`plausible bench`."""
import json
from pathlib import Path

import numpy as np

from .. import brdf
from ..cli import CommandError
from ..verify import efficiency, interface_cost, plots, standards, subject
from . import furnace

DESCRIPTION = ("Compare the efficiency of our models, 1 / (relative variance x time) on a sphere, with that of Cycles' "
               "own closures in the same scenes: phong_ramp of the same exponent, and Ashikhmin-Shirley beside Blinn; "
               "beside lumps on the disk, Beckmann's and GGX microfacets as wide at normal incidence.")
MODELS = ("pumped_phong", "pumped_blinn")
SAMPLES = (1, 2, 4, 8)
TITLES = {efficiency.SKY: "HDRI", efficiency.AREA: "area light", efficiency.SUN: "sun of no size"}


def add_arguments(parser):
    parser.add_argument("models", nargs="*", metavar="MODEL", help=f"models (default: {' '.join(MODELS)})")
    parser.add_argument("--set", action="append", default=[], metavar="PARAMETER=VALUE", dest="assignments",
                        help="as in `plausible furnace`; exponent=20 and pumps=1 where not given")
    parser.add_argument("--scenes", nargs="+", choices=efficiency.SCENES, default=list(efficiency.SCENES),
                        help="where to render (default: all)")
    parser.add_argument("--samples", type=int, nargs="+", default=list(SAMPLES), metavar="N",
                        help="samples per hit of our models (default: %(default)s)")
    parser.add_argument("--hdri", metavar="FILE", help="HDRI to light with (default: one that comes with Blender)")
    parser.add_argument("--resolution", type=int, default=64, metavar="N", help="pixels across (default: %(default)s)")
    parser.add_argument("--interface", action="store_true",
                        help="time what the panel computes while a slider is dragged, instead of renders (of all "
                        "models where none is named)")
    parser.add_argument("--quick", action="store_true", help="short renders: a rough figure in a minute")
    parser.add_argument("--output", metavar="FILE.png", help="write a plot")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments):
    if arguments.interface:
        return _interface(arguments)
    if arguments.output:
        plots.check(arguments.output)
    if arguments.hdri and not Path(arguments.hdri).is_file():
        raise CommandError(f"no file {arguments.hdri}")
    plan = [_subjects(model, arguments) for model in arguments.models or MODELS]
    effort = {"seconds": 0.3, "seeds": 4} if arguments.quick else {"seconds": 1.0, "seeds": 5}
    results = []
    for model, materials, references in plan:
        for scene in arguments.scenes:
            rows = efficiency.measure(materials, scene, resolution=arguments.resolution, hdri=arguments.hdri,
                                      progress=furnace.progress(f"bench, {model.label}, {TITLES[scene]}"), **effort)
            results.append((model, scene, rows, references))
    if arguments.output:
        _plot(arguments.output, results)
    if arguments.json:
        print(json.dumps(_report(arguments, results), indent=2))
    else:
        _print(results)


def _interface(arguments):
    models = [brdf.find_model(name).id for name in arguments.models or brdf.MODELS]
    rows = interface_cost.measure(models)
    if arguments.json:
        print(json.dumps({"unit": "ms of processor time", "rows": rows}, indent=2))
        return
    print(f"{'ms of processor time':26}  plot  stand-in")
    for row in rows:
        print(f"{row['model']:26} {row['plot_ms']:5.0f} {row['stand_in_ms']:9.0f}")


def _subjects(model_id, arguments):
    """A model, {title: material} of the references and then ours, and how many references there are."""
    if model_id not in brdf.MODELS:
        raise CommandError(f"no model {model_id!r}; there are {', '.join(brdf.MODELS)}")
    model = brdf.MODELS[model_id]
    values = model.resolve(subject.settings(model, arguments.assignments))
    closures = _closures(model, values)
    materials = {closure.id.replace("phong", "phong_ramp"): closure.material() for closure in closures}
    for count in arguments.samples:
        chosen = [a for a in arguments.assignments if not a.startswith("samples")] + [f"samples={count}"]
        materials[f"{model_id}, {count}"] = subject.of_model(model_id, chosen).material
    return model, materials, len(closures)


def _closures(model, values):
    """Cycles' own closures that come nearest to a model: of the same exponent, or as wide at normal incidence."""
    if model.base_family is None:
        alpha = (2.0 / (model.stand_in(values)[1] + 2.0)) ** 0.5
        return [standards.microfacet("beckmann", alpha), standards.microfacet("ggx", alpha)]
    closures = [standards.phong(values["exponent"])]
    if model.base_family == "blinn":
        closures.append(standards.ashikhmin_shirley(values["exponent"]))
    return closures


def _compared(rows, references):
    """(row, its efficiency over each reference's) of ours."""
    return [(row, [row.compared_with(reference) for reference in rows[:references]]) for row in rows[references:]]


def _report(arguments, results):
    import bpy

    scenes = []
    for model, scene, rows, references in results:
        ours = dict(_compared(rows, references))
        scenes.append({"model": model.id, "scene": scene, "rows": [{
            "title": row.title, "relative_variance": row.relative_variance, "seconds": row.seconds, "spp": row.spp,
            "variance_per_sample": row.relative_variance * row.spp, "seconds_per_sample": row.seconds / row.spp,
            "efficiency": row.value if np.isfinite(row.value) else None,
            "relative_to": {r.title: ratio for r, ratio in zip(rows[:references], ours[row], strict=True)}
            if row in ours else None,
        } for row in rows]})
    return {"blender": bpy.app.version_string, "settings": arguments.assignments, "results": scenes}


def _print(results):
    for model, scene, rows, references in results:
        print(f"{model.label}, {TITLES[scene]}, {rows[0].spp} samples per pixel")
        names = "  ".join(f"of {row.title}" for row in rows[:references])
        print(f"  {'material, samples per hit':30} variance x spp   time/spp [ms]   efficiency {names}")
        ours = dict(_compared(rows, references))
        for row in rows:
            ratios = "  ".join(f"{'-' if ratio is None else format(ratio, '.2f'):>{3 + len(r.title)}}"
                               for r, ratio in zip(rows[:references], ours.get(row, ()), strict=row in ours))
            print(f"  {row.title:30} {row.relative_variance * row.spp:14.4g}   {1e3 * row.seconds / row.spp:13.3f}   "
                  f"{'':10} {ratios}".rstrip())
        print()


def _plot(path, results):
    """Bars of the efficiency over that of the first reference, a panel per model and scene that has noise."""
    plt = plots._pyplot()
    shown = [(m, s, rows, n) for m, s, rows, n in results
             if any(ratio is not None for _, ratios in _compared(rows, n) for ratio in ratios)]
    figure, axes = plt.subplots(1, max(len(shown), 1), figsize=(3.4 * max(len(shown), 1), 3.6), squeeze=False,
                                layout="constrained")
    for axis, (model, scene, rows, references) in zip(axes[0], shown, strict=False):
        ours = _compared(rows, references)
        width = 0.8 / references
        for i, reference in enumerate(rows[:references]):
            heights = [ratios[i] or 0.0 for _, ratios in ours]
            bars = axis.bar(np.arange(len(ours)) + (i - 0.5 * (references - 1)) * width, heights, 0.92 * width,
                            color=plots.VIEWS[i], label=f"against {reference.title}")
            axis.bar_label(bars, fmt="%.2f", fontsize=8)
        axis.axhline(1.0, color=plots.INK, lw=0.8, ls=(0, (4, 3)))
        axis.set(title=f"{model.label}, {TITLES[scene]}", xlabel="samples per hit", ylabel="relative efficiency",
                 xticks=range(len(ours)), xticklabels=[row.title.rsplit(", ")[-1] for row, _ in ours])
        axis.legend(frameon=False, fontsize=8)
    figure.savefig(path)
    plt.close(figure)
