"""Noise and time of the models beside Cycles' own closures: `efficiency` over models and scenes."""
import numpy as np

from ... import brdf
from ...measure import plots, specimen
from . import efficiency, nearest

TITLES = {efficiency.FURNACE: "white furnace", efficiency.SKY: "HDRI", efficiency.AREA: "area light",
          efficiency.SUN: "sun of no size", efficiency.FULL: "room"}
GOAL, SLOWEST = 0.8, 1.3  # aims of pumped models and lumps, in parts of the nearest closure's efficiency and time


def measure(effort, progress, models=None, scenes=efficiency.SCENES, samples=(4,), assignments=(), hdri=None,
            resolution=64) -> dict:
    """{results: [{model, scene, rows}]}; a row has variance and seconds per sample.

    Rows of our models also have their ratios to Cycles' own materials. Raises ValueError for a wrong model, value or
    scene before the first render.
    """
    chosen = [brdf.find_model(name) for name in models or brdf.MODELS]
    for model in chosen:
        for count in samples:
            values = specimen.settings(model, [*assignments, f"samples={count}"])
            model.resolve(values)
    results, done = [], 0
    for model in chosen:
        values = model.resolve(specimen.settings(model, assignments))
        natives = nearest.natives(model, values)
        candidates = [*natives, *(nearest.ours(model, assignments, count) for count in samples),
                      nearest.base_alone(model, assignments)]
        for scene in scenes:
            rows = efficiency.measure(candidates, scene, effort, resolution, hdri)
            results.append({"model": model.id, "scene": scene, "rows": [
                _row(row, rows[:len(natives)] if i >= len(natives) else []) for i, row in enumerate(rows)]})
            done += 1
            progress(done, len(chosen) * len(scenes))
    return {"settings": list(assignments), "results": results}


def _row(row, natives):
    """An Efficiency as a dict, with its ratios to those of `natives`."""
    return {
        "title": row.title, "spp": row.spp, "variance_per_sample": row.relative_variance * row.spp,
        "seconds_per_sample": row.seconds / row.spp,
        "efficiency": {native.title: row.compared_with(native) for native in natives},
        "time": {native.title: row.seconds / native.seconds for native in natives},
    }


def lines(report):
    """Yields a table for each model and scene, then the medians of the scenes."""
    for result in report["results"]:
        yield f"{result['model']}, {TITLES[result['scene']]}, {result['rows'][0]['spp']} samples per pixel"
        names = list(result["rows"][-1]["efficiency"])
        yield (f"  {'material, samples per hit':34} variance x spp  ms/sample   "
               + "   ".join(f"efficiency, time of {name}" for name in names))
        for row in result["rows"]:
            ratios = "   ".join(f"{_ratio(row['efficiency'][name])}, x{row['time'][name]:.2f}".rjust(20 + len(name))
                                for name in row["efficiency"])
            yield (f"  {row['title']:34} {row['variance_per_sample']:14.4g} {1e3 * row['seconds_per_sample']:10.3f}   "
                   f"{ratios}").rstrip()
        yield ""
    for scene, (best, slow) in summary(report).items():
        yield (f"{TITLES[scene]}: efficiency over the closure's in OSL, median of the models {best:.2f}, "
               f"time x{slow:.2f}")


def summary(report) -> dict:
    """{scene: (median efficiency, median time) of our models over the closure in OSL}."""
    ratios = {}
    for result in report["results"]:
        for row in result["rows"]:
            name = next(iter(row["efficiency"]), None)
            if name and "base alone" not in row["title"] and row["efficiency"][name] is not None:
                ratios.setdefault(result["scene"], []).append((row["efficiency"][name], row["time"][name]))
    return {scene: tuple(np.median(pairs, axis=0)) for scene, pairs in ratios.items()}


def _ratio(value):
    return "-" if value is None else f"{value:.2f}"


def draw(report):
    """Plots efficiency and time of each model and its base alone over the closure in OSL; a color for each scene."""
    plt = plots._pyplot()
    scenes = list(dict.fromkeys(result["scene"] for result in report["results"]))
    models = list(dict.fromkeys(result["model"] for result in report["results"]))
    figure, axes = plt.subplots(1, 2, figsize=(11.0, 1.6 + 0.3 * len(models)), sharey=True, layout="constrained")
    for result in report["results"]:
        offset = 0.5 - (scenes.index(result["scene"]) + 0.5) / len(scenes)
        y = len(models) - 1 - models.index(result["model"]) + 0.6 * offset
        for row in result["rows"]:
            name = next(iter(row["efficiency"]), None)
            if name is None:
                continue
            alone = "base alone" in row["title"]
            look = {"color": plots.VIEWS[scenes.index(result["scene"])], "mfc": "white" if alone else None,
                    "marker": "o", "ms": 3.5 if alone else 5.5, "ls": "", "zorder": 2 if alone else 3}
            if row["efficiency"][name] is not None:
                axes[0].plot(row["efficiency"][name], y, **look)
            axes[1].plot(row["time"][name], y, **look)
    axes[0].axvline(GOAL, color=plots.INK, lw=0.8, ls=(0, (4, 3)))
    axes[1].axvline(SLOWEST, color=plots.INK, lw=0.8, ls=(0, (4, 3)))
    axes[0].set(xscale="log", xlabel="efficiency over that of the nearest closure (OSL); right is better",
                yticks=range(len(models)), yticklabels=models[::-1], ylim=(-0.6, len(models) - 0.4))
    axes[1].set(xscale="log", xlabel="time per sample over that closure's; left is better")
    for i, scene in enumerate(scenes):
        axes[1].plot([], [], "o", color=plots.VIEWS[i], label=TITLES[scene])
    axes[1].plot([], [], "o", color=plots.INK, mfc="white", ms=3.5, label="base alone: a bound")
    axes[1].legend(frameon=False, fontsize=8, loc="best")
    return figure
