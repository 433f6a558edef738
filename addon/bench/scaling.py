"""How time grows with the work: samples per hit, resolution, and materials in a scene, beside a closure of Cycles."""
import numpy as np

from .. import brdf
from ..verify import plots, room
from . import efficiency, nearest

MODEL = "pumped_phong"
SAMPLES, RESOLUTIONS, MATERIALS = (1, 2, 4, 8), (32, 64, 128, 256), (1, 2, 4, 8, 16, 32)
SPP = 16


def measure(effort, progress, model=MODEL) -> dict:
    """{samples, resolution, materials: rows}, each with `work` and milliseconds of processor time of ours and theirs.

    By resolution it is the time per pixel and sample; by materials that of a whole render, `first` the one in which
    Cycles loads them.
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
    """Milliseconds per million pixel samples of ours and of the closure, on a sphere under an HDRI."""
    found = {}
    spp = max(int(0.3e6 * effort.seconds) // resolution**2, 2)  # of some microseconds each
    with _sphere(mine, resolution) as one, _sphere(closure, resolution) as other:
        for name, place in (("ours", one), ("closure", other)):
            place.render(1)
            long = np.median([efficiency.timed(place, spp + 1, i)[0] for i in range(effort.repeats)])
            short = np.median([efficiency.timed(place, 1, i)[0] for i in range(effort.repeats)])
            found[name] = 1e9 * (long - short) / (spp * resolution**2)
    return found


def _sphere(candidate, resolution):
    place = room.Room(candidate.material, room.BALL, resolution)
    place.sky(1.0, efficiency.hdri_of_blender())
    place.look_from((0.0, 0.0, 1.0), 2.0)
    return place


def _of_materials(model, closure, count, effort):
    """Milliseconds of a render with `count` materials of ours (of as many exponents), and of copies of the closure."""
    exponents = np.geomspace(5.0, 500.0, count)
    mine = [nearest.ours(model, [f"exponent={float(n)!r}"], 4).material for n in exponents]
    theirs = [closure.material.copy() for _ in exponents]
    found = {}
    for name, materials in (("ours", mine), ("closure", theirs)):
        with room.Room(materials[0], room.PLANE, 64) as place:
            place.divide(materials)
            place.sky(1.0)
            place.look_from((0.0, 0.0, 1.0))
            place.scene.render.use_persistent_data = False
            first = np.median([efficiency.timed(place, 1, i)[0] for i in range(effort.repeats)])
            whole = np.median([efficiency.timed(place, SPP + 1, i)[0] for i in range(effort.repeats)])
        found[name], found[f"{name}_first"] = 1e3 * (whole - first), 1e3 * first
    return found


def lines(report):
    yield f"{report['model']} beside {report['closure']}"
    for key, unit in (("samples", "ms per million samples"), ("resolution", "ms per million samples"),
                      ("materials", f"ms for {SPP} samples; loading")):
        yield f"  {key} ({unit})"
        for row in report[key]:
            loading = f"   {row['ours_first']:7.0f} {row['closure_first']:7.0f}" if "ours_first" in row else ""
            yield (f"    {row['work']:6d} {row['ours']:9.0f} {row['closure']:9.0f}   "
                   f"x{row['ours'] / row['closure']:.2f}{loading}")


def draw(report):
    """Three panels, time over work on logarithmic axes."""
    plt = plots._pyplot()
    figure, axes = plt.subplots(1, 3, figsize=(12.0, 3.6), layout="constrained")
    for axis, key, label in zip(axes, ("samples", "resolution", "materials"),
                                ("samples per hit", "pixels across", "materials"), strict=True):
        rows = report[key]
        for i, name in enumerate(("ours", "closure")):
            title = report["model"] if name == "ours" else report["closure"]
            axis.plot([r["work"] for r in rows], [r[name] for r in rows], "o-", color=plots.VIEWS[i], ms=4, label=title)
            if key == "materials":
                axis.plot([r["work"] for r in rows], [r[f"{name}_first"] for r in rows], "o--", ms=3,
                          color=plots.VIEWS[i], label=f"{title}: loading")
        axis.set(xscale="log", yscale="log", xlabel=label, xticks=[r["work"] for r in rows],
                 xticklabels=[r["work"] for r in rows],
                 ylabel=f"ms for {SPP} samples" if key == "materials" else "ms per million samples")
        axis.minorticks_off()
        axis.legend(frameon=False, fontsize=8)
    return figure
