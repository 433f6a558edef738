"""Time over the work: samples per hit, resolution, and materials in a scene, beside a closure of Cycles."""
import numpy as np

from ... import brdf
from ...measure import plots, scene
from . import efficiency, nearest
from .clock import milliseconds

MODEL = "pumped_phong"
SAMPLES, RESOLUTIONS, MATERIALS = (1, 2, 4, 8), (32, 64, 128, 256), (1, 2, 4, 8, 16, 32)
PIXEL_SAMPLES = 0.3e6  # samples per second of effort; each takes some microseconds


def measure(effort, progress, model=MODEL) -> dict:
    """{samples, resolution, materials: rows}; a row has `work` and the processor times `ours` and `closure`.

    These are milliseconds per million samples of a pixel. Rows of materials also have `ours_first` and `closure_first`,
    milliseconds of the render in which Cycles loads and compiles the materials.
    """
    chosen = brdf.find_model(model)
    closure, _ = nearest.natives(chosen, chosen.resolve({}))
    total = len(SAMPLES) + len(RESOLUTIONS) + len(MATERIALS)
    mine = nearest.ours(chosen, (), 4)
    report = {"model": chosen.id, "closure": closure.title, "samples": [], "resolution": [], "materials": []}
    for i, count in enumerate(SAMPLES):
        report["samples"].append({"work": count, **_per_sample(nearest.ours(chosen, (), count), closure, 64, effort)})
        progress(i + 1, total)
    for i, size in enumerate(RESOLUTIONS):
        report["resolution"].append({"work": size, **_per_sample(mine, closure, size, effort)})
        progress(len(SAMPLES) + i + 1, total)
    for i, count in enumerate(MATERIALS):
        report["materials"].append({"work": count, **_of_materials(chosen, closure, count, effort)})
        progress(len(SAMPLES) + len(RESOLUTIONS) + i + 1, total)
    return report


def _per_sample(mine, closure, resolution, effort):
    """Times of our material and of the closure on a sphere under an HDRI."""
    with _sphere(mine, resolution) as one, _sphere(closure, resolution) as other:
        return {"ours": _per_million(one, effort), "closure": _per_million(other, effort)}


def _per_million(stage, effort):
    """Milliseconds per million samples of a measuring scene's pixels, without the time of loading."""
    pixels = stage.resolution**2
    spp = max(int(PIXEL_SAMPLES * effort.seconds) // pixels, 2)
    stage.render(1)
    long = np.median([efficiency.timed(stage, spp + 1, i)[0] for i in range(effort.repeats)])
    short = np.median([efficiency.timed(stage, 1, i)[0] for i in range(effort.repeats)])
    return 1e9 * float(long - short) / (spp * pixels)


def _sphere(candidate, resolution):
    """A measuring scene with a candidate on a sphere under an HDRI."""
    stage = scene.MeasuringScene(candidate.material, scene.BALL, resolution)
    stage.sky(1.0, efficiency.hdri_of_blender())
    stage.look_from((0.0, 0.0, 1.0), 2.0)
    return stage


def _of_materials(model, closure, count, effort):
    """Times of `count` materials of ours, of different exponents, and of copies of the closure, on a plane's strips."""
    exponents = np.geomspace(5.0, 500.0, count)
    mine = [nearest.ours(model, [f"exponent={float(n)!r}"], 4).material for n in exponents]
    theirs = [closure.material.copy() for _ in exponents]
    times = {}
    for name, materials in (("ours", mine), ("closure", theirs)):
        with scene.MeasuringScene(materials[0], scene.PLANE, 64) as stage:
            stage.divide(materials)
            stage.sky(1.0)
            stage.look_from((0.0, 0.0, 1.0))
            times[name] = _per_million(stage, effort)
            stage.scene.render.use_persistent_data = False
            times[f"{name}_first"] = milliseconds(lambda stage=stage: stage.render(1), effort.repeats)
    return times


def lines(report):
    """Yields the rows of each kind of work."""
    yield f"{report['model']} beside {report['closure']}"
    for key in ("samples", "resolution", "materials"):
        yield f"  {key} (ms per million samples{'; loading' if key == 'materials' else ''})"
        for row in report[key]:
            loading = f"   {row['ours_first']:7.0f} {row['closure_first']:7.0f}" if "ours_first" in row else ""
            yield (f"    {row['work']:6d} {row['ours']:9.0f} {row['closure']:9.0f}   "
                   f"x{row['ours'] / row['closure']:.2f}{loading}")


def draw(report):
    """Four panels: time per sample over each kind of work, and the time to load materials."""
    plt = plots._pyplot()
    figure, axes = plt.subplots(1, 4, figsize=(13.0, 3.4), layout="constrained")
    panels = (("samples", "", "samples per hit"), ("resolution", "", "pixels across"), ("materials", "", "materials"),
              ("materials", "_first", "materials"))
    for axis, (key, suffix, label) in zip(axes, panels, strict=True):
        rows = report[key]
        for i, (name, title) in enumerate((("ours", report["model"]), ("closure", report["closure"]))):
            axis.plot([r["work"] for r in rows], [r[name + suffix] for r in rows], "o-", color=plots.VIEWS[i], ms=4,
                      label=title)
        axis.set(xscale="log", xlabel=label, ylabel="ms to load" if suffix else "ms per million samples")
        axis.set_xticks([r["work"] for r in rows], [r["work"] for r in rows])
        axis.xaxis.minorticks_off()
        axis.set_ylim(bottom=0.0)
        axis.legend(frameon=False, fontsize=8)
    return figure
