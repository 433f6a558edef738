"""Another renderer judges: Mitsuba's chi-square test of the samplers, and the same scenes in it and in Cycles.

Mitsuba runs in a process of its own, see mitsuba_judge.py; in an environment where it is installed, or by the
interpreter that PLAUSIBLE_MITSUBA_PYTHON names.
"""
import importlib.util
import json
import os
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from addon.brdf import MODELS
from addon.measure import plots
from addon.models.geometry import in_plane
from addon.statistics.chi_square import significance

PYTHON = os.environ.get("PLAUSIBLE_MITSUBA_PYTHON") or sys.executable
LLVM = "libLLVM.so.19.1"
JUDGE = Path(__file__).parent / "optics" / "mitsuba_judge.py"


def missing():
    """What keeps Mitsuba from running here, "" where nothing does."""
    if sys.executable == PYTHON and importlib.util.find_spec("mitsuba") is None:
        return "Mitsuba is not installed here; in Python 3.13 it comes with plausible-brdf[test]"
    # Asked of another process: this one may hold Blender's LLVM, and bears no second.
    tried = subprocess.run([sys.executable, "-c", f"import ctypes; ctypes.CDLL('{LLVM}')"], capture_output=True)
    return f"{LLVM}, which Mitsuba compiles by, is not installed here" if tried.returncode else ""


MISSING = missing()
pytestmark = [pytest.mark.proof, pytest.mark.skipif(MISSING != "", reason=MISSING or "nothing is missing")]


def judged(what, jobs, folder):
    """What Mitsuba says of `jobs`, see mitsuba_judge.py."""
    path = folder / "jobs.json"
    path.write_text(json.dumps(jobs), encoding="utf-8")
    result = subprocess.run([PYTHON, str(JUDGE), what, str(path)], capture_output=True, text=True, cwd=folder)
    assert result.returncode == 0, result.stderr[-3000:]
    return json.loads(result.stdout)


# The chi-square test, one configuration of each family: of lobes a few of its cells wide and without steps, for it adds
# up densities by the trapezium rule inside even cells.

CHI_SQUARE = [
    ("phong", 60.0, {}), ("pumped_blinn", 40.0, {"exponent": 50.0}), ("phong_limit", 85.0, {"exponent": 5.0}),
    ("disk_scaling", 50.0, {"radius_u": 0.3, "radius_v": 0.7, "rotation": 0.1}),
    ("disk_orthogonal", 30.0, {"radius_u": 0.5}), ("edwards_empirical", 50.0, {"retro": 0.4, "base_color": 0.5}),
    ("edwards_fit", 45.0, {}), ("reciprocal_disk", 60.0, {"exponent": 4.0}),
    ("ward", 45.0, {"roughness_u": 0.2, "roughness_v": 0.5, "diffuse_color": 0.3}), ("ward_bounded", 30.0, {}),
    ("cook_torrance", 40.0, {}), ("he_torrance", 30.0, {}), ("embrechts", 60.0, {}),
    ("ashikhmin_shirley", 45.0, {"exponent_u": 100.0, "exponent_v": 10.0, "base_color": 0.4, "diffuse_color": 0.5}),
    ("lafortune", 50.0, {}), ("weighted_lobes", 30.0, {}), ("kajiya_kay", 70.0, {}),
    ("pumped_ward", 20.0, {"roughness_u": 0.4}),
]
PLANTED = [("phong", 60.0, {}, {"exponent": 20.6}), ("pumped_blinn", 40.0, {"exponent": 50.0}, {"exponent": 51.5}),
           ("disk_scaling", 50.0, {"rotation": 0.1, "radius_u": 0.5}, {"rotation": 0.11, "radius_u": 0.5}),
           ("ward", 45.0, {}, {"roughness_u": 0.155}),
           ("lafortune", 50.0, {}, {"weight_2": 0.12})]


def chi_square_jobs():
    right = [{"model": model, "parameters": parameters, "view": in_plane([angle])[0].tolist()}
             for model, angle, parameters in CHI_SQUARE]
    wrong = [{"model": model, "parameters": parameters, "claimed": claimed, "view": in_plane([angle])[0].tolist()}
             for model, angle, parameters, claimed in PLANTED]
    for job in (*right, *wrong):
        job["name"] = f"{job['model']} {job['parameters']}" + (" claimed" if "claimed" in job else "")
        job.update(tests=len(CHI_SQUARE), seed=zlib.crc32(job["name"].encode()) % 2**31)
    return right, wrong


def test_mitsubas_chi_square_test_accepts_the_samplers_and_rejects_what_is_planted(tmp_path):
    right, wrong = chi_square_jobs()
    assert {job["model"] for job in right} <= set(MODELS) and len(right) >= 15
    verdicts = judged("chi2", right + wrong, tmp_path)
    refused = [v for v in verdicts[:len(right)] if not v["passes"]]
    assert refused == [], "\n".join(f"{v['name']}: {v['messages']}" for v in refused)
    assert [v["name"] for v in verdicts[len(right):] if v["passes"]] == []


# The same scenes in Cycles, by our shaders, and in Mitsuba, by our formulas in NumPy.

SIZE, WIDTH = 32, 2.0 * (1.0 + 1.0 / 32)
SAMPLES, SEEDS = 49, 10
SLANT = [0.36, 0.48, 0.8]
AREA = {"distance": 3.5, "size": 1.5}
AREA_RADIANCE = 10.0
SCENES = ("furnace", "sun", "area", "hdri")
MATERIALS = {"pumped_phong": {"exponent": 20.0, "base_color": (1.0, 0.7, 0.3)}, "pumped_blinn": {"exponent": 40.0},
             "disk_scaling": {"exponent": 10.0}, "ward": {"roughness_u": 0.3, "roughness_v": 0.3}}
# As wide by a twentieth less or more: what the picture of a sun must tell.
PLANTED_WIDTHS = {"pumped_phong": {"exponent": 21.0}, "pumped_blinn": {"exponent": 42.0},
                  "disk_scaling": {"exponent": 10.5}, "ward": {"roughness_u": 0.315, "roughness_v": 0.315}}
# How far Cycles may be off beside the noise, as it is an estimate by kernels and lobe rows: parts of a pixel, of the
# brightest one, of all light.
LOCAL, GLARE, TOTAL = 0.01, 0.003, 0.005
LEVEL = significance(0.01, 2 * len(SCENES) * len(MATERIALS))


class Pictures:
    """Pictures of a ball by both renderers, (seeds, SIZE, SIZE, 3) each; pixels that see the ball alone count."""

    def __init__(self, cycles, mitsuba):
        self.cycles, self.mitsuba = cycles, mitsuba
        edges = WIDTH * (np.arange(SIZE + 1) / SIZE - 0.5)
        farthest = np.maximum(np.abs(edges[:-1]), np.abs(edges[1:]))
        self.covered = farthest[:, None] ** 2 + farthest**2 < 1.0

    def gray(self):
        """Means over channels of the pixels, (seeds, N) each."""
        return [pictures[:, self.covered].mean(axis=-1) for pictures in (self.cycles, self.mitsuba)]

    def sums(self):
        """Sums over the pixels of each channel, (seeds, 3) each."""
        return [pictures[:, self.covered].sum(axis=1) for pictures in (self.cycles, self.mitsuba)]

    def pixels(self):
        """p values (N,) that both differ in a pixel by no more than Cycles may."""
        a, b = self.gray()
        return welch(a, b, allowed(b))

    def total(self):
        """p values (3,) that both differ in a channel's total by no more than Cycles may."""
        a, b = self.sums()
        return welch(a, b, TOTAL * b.mean(axis=0))

    def faults(self):
        """What differs, in words; empty where nothing does. One of all tests' verdicts is wrong in a hundred runs."""
        found = {"pixels": self.pixels(), "total": self.total()}
        return [what for what, p in found.items() if p.min() < significance(LEVEL, len(p))]

    def detected(self):
        """By which part of the total, and of a bright pixel, above a quarter of the brightest, a difference is found:
        where that is median."""
        a, b = self.sums()
        total = TOTAL + np.max(least(a, b, significance(LEVEL, 3)) / b.mean(axis=0))
        a, b = self.gray()
        part = (allowed(b) + least(a, b, significance(LEVEL, a.shape[1]))) / np.maximum(b.mean(axis=0), 1e-30)
        return total, np.median(part[b.mean(axis=0) > 0.25 * b.mean(axis=0).max()])

    def deviations(self):
        """Difference over its standard error, averaged over channels, (SIZE, SIZE), NaN outside the ball."""
        a, b = (x.mean(axis=-1) for x in (self.cycles, self.mitsuba))
        error = np.sqrt(a.var(axis=0, ddof=1) / len(a) + b.var(axis=0, ddof=1) / len(b))
        return np.where(self.covered, (a.mean(axis=0) - b.mean(axis=0)) / np.maximum(error, 1e-12), np.nan)

    def __repr__(self):
        (a, b), (total, pixel) = self.sums(), self.detected()
        return (f"totals differ by {np.array2string(a.mean(axis=0) / b.mean(axis=0) - 1.0, precision=4)}, p "
                f"{self.total().min():.2g}; smallest p of {self.pixels().size} pixels {self.pixels().min():.2g}; "
                f"would see {total:.2%} of the total, {pixel:.1%} of a bright pixel")


def allowed(pictures):
    """How far Cycles' pixels may be from those of Mitsuba's pictures (M, N), (N,)."""
    mean = pictures.mean(axis=0)
    return LOCAL * mean + GLARE * mean.max()


def errors(a, b):
    """Standard error (N,) of the difference of the means of rows, and its degrees of freedom (Welch)."""
    va, vb = a.var(axis=0, ddof=1) / len(a), b.var(axis=0, ddof=1) / len(b)
    degrees = (va + vb) ** 2 / np.maximum(va**2 / (len(a) - 1) + vb**2 / (len(b) - 1), 1e-300)
    return np.sqrt(va + vb), np.maximum(degrees, 1.0)


def welch(a, b, allowed):
    """Two-sided p values (N,) of means of rows (M, N) that differ by more than `allowed` (N,)."""
    error, degrees = errors(a, b)
    beyond = np.maximum(np.abs(a.mean(axis=0) - b.mean(axis=0)) - allowed, 0.0)
    return np.where(beyond > 0.0, 2.0 * stats.t.sf(beyond / np.maximum(error, 1e-12), degrees), 1.0)


def least(a, b, level):
    """The difference (N,) beyond what is allowed that has a p value of `level`."""
    error, degrees = errors(a, b)
    return error * stats.t.isf(0.5 * level, degrees)


def hdri(bpy):
    """One of Blender's own that every reader reads alike: others tell of primaries, which it leaves as they are."""
    return str(Path(bpy.utils.resource_path("LOCAL"), "datafiles", "studiolights", "world", "courtyard.exr"))


def by_mitsuba(bpy, folder):
    """{(model, scene): pictures}; of the scene "planted" the sun's with a wrong width."""
    lights = {"furnace": {"sky": 1.0}, "sun": {"sun": SLANT}, "hdri": {"image": hdri(bpy)},
              "area": {"area": SLANT, **AREA, "radiance": AREA_RADIANCE}, "planted": {"sun": SLANT}}
    jobs = [{"model": model, "parameters": {**parameters, **(PLANTED_WIDTHS[model] if scene == "planted" else {})},
             "light": lights[scene], "resolution": SIZE, "width": WIDTH, "samples": SAMPLES, "seeds": SEEDS,
             "output": str(folder / f"{model}-{scene}.npy")}
            for model, parameters in MATERIALS.items() for scene in lights]
    judged("render", jobs, folder)
    return {tuple(Path(job["output"]).stem.split("-")): np.load(job["output"]).astype(np.float64) for job in jobs}


def by_cycles(bpy):
    """{(model, scene): pictures}."""
    from addon import create_material
    from addon.measure.scene import BALL, SUN_ENERGY, MeasuringScene

    found = {}
    for model, parameters in MATERIALS.items():
        material = create_material(model, **parameters)
        for scene in SCENES:
            with MeasuringScene(material, BALL, SIZE) as place:
                place.scene.cycles.pixel_filter_type = "BOX"
                place.look_from((0.0, 0.0, 1.0), WIDTH)
                place.sky(float(scene in ("furnace", "hdri")), hdri(bpy) if scene == "hdri" else None)
                if scene == "sun":
                    place.shine("SUN", SLANT, energy=SUN_ENERGY, angle=0.0)
                if scene == "area":  # a square's radiance is its power over pi and its area
                    power = np.pi * AREA["size"] ** 2 * AREA_RADIANCE
                    place.shine("AREA", SLANT, shape="SQUARE", energy=power, **AREA)
                found[model, scene] = np.array([place.render(SAMPLES, seed) for seed in range(SEEDS)])
    return found


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    import bpy

    mitsuba, cycles = by_mitsuba(bpy, tmp_path_factory.mktemp("mitsuba")), by_cycles(bpy)
    return {(model, scene): Pictures(cycles[model, "sun" if scene == "planted" else scene], picture)
            for (model, scene), picture in mitsuba.items()}


@pytest.mark.blender
@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("model", MATERIALS)
def test_cycles_and_mitsuba_show_the_same(pictures, model, scene):
    found = pictures[model, scene]
    print(model, scene, found)
    assert found.faults() == [], found
    total, pixel = found.detected()
    assert total < 0.03 and pixel < (0.5 if scene == "hdri" else 0.25), f"too noisy to see much: {found}"


@pytest.mark.blender
@pytest.mark.parametrize("model", MATERIALS)
def test_what_is_planted_is_seen(pictures, model):
    """A twentieth of the width, by pixels under a sun; 3 per cent of the light, by the total, anywhere."""
    assert "pixels" in pictures[model, "planted"].faults(), pictures[model, "planted"]
    for scene in SCENES:
        found = pictures[model, scene]
        for factor in (0.97, 1.03):
            assert "total" in Pictures(factor * found.cycles, found.mitsuba).faults(), (scene, found)


@pytest.mark.blender
def test_picture(pictures, tmp_path):
    """Side by side; PLAUSIBLE_MITSUBA_PICTURE says where it is kept."""
    path = Path(os.environ.get("PLAUSIBLE_MITSUBA_PICTURE") or tmp_path / "mitsuba.png")
    draw(path, pictures)
    assert path.stat().st_size > 20000


def draw(path, pictures):
    """Rows of models; for each scene Cycles, Mitsuba, and their difference in standard errors."""
    plots.check(path)
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(len(MATERIALS), 3 * len(SCENES), figsize=(15.0, 5.6), layout="constrained")
    for row, model in enumerate(MATERIALS):
        for column, scene in enumerate(SCENES):
            found, (left, middle, right) = pictures[model, scene], axes[row, 3 * column:3 * column + 3]
            means = found.cycles.mean(axis=0), found.mitsuba.mean(axis=0)
            white = 1.25 if scene == "furnace" else np.quantile(means[1][found.covered], 0.995)
            for axis, picture, name in ((left, means[0], "Cycles"), (middle, means[1], "Mitsuba")):
                axis.imshow(np.clip(picture / white, 0.0, 1.0) ** (1.0 / 2.2), origin="lower", interpolation="nearest")
                axis.set_title(f"{scene}: {name}" if row == 0 else "", fontsize=9)
            shown = right.imshow(found.deviations(), vmin=-5.0, vmax=5.0, cmap="RdBu_r", origin="lower",
                                 interpolation="nearest")
            right.set_title("difference / σ" if row == 0 else "", fontsize=9)
            for axis in (left, middle, right):
                axis.set(xticks=[], yticks=[])
                axis.grid(False)
                axis.spines[:].set_visible(False)
        axes[row, 0].set_ylabel(MODELS[model].label, fontsize=9)
    figure.colorbar(shown, ax=axes, fraction=0.015, pad=0.01)
    figure.savefig(path)
    plt.close(figure)
