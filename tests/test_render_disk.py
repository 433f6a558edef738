"""What Cycles renders of lumps on the halfway vector disk is what the formulas say.

As in test_render.py the truth is NumPy, bounds are two-sided and widened by five standard errors, and each test asserts
that these are small enough to decide.
"""
import numpy as np
import pytest
from blender_help.materials import plant, sockets_of
from optics.directions import cosines, rgb
from optics.furnace import FURNACE_BOUND, FURNACE_NOISE, SIGMAS, albedo_of, assert_good
from optics.lamp import total_under_the_lamp
from optics.plane import plane
from optics.points import POINT_BOUND, POINT_NOISE, directions_of
from optics.sun import SUN_SAMPLES, TOTAL_BOUND, TOTAL_NOISE, Sun, ball

from addon import brdf, create_material, measure
from addon.measure import comparison, scene
from addon.models.geometry import view_at

pytestmark = pytest.mark.blender

ANGLES = (1.0, 45.0, 70.0, 85.0)
SMALL, THIN = {"radius_u": 0.05, "radius_v": 0.05}, {"radius_u": 1.0, "radius_v": 0.1, "rotation": 0.1}
WHITE = {"base_color": 1.0, "f90": 1.0}


def name_of(value):
    if not isinstance(value, dict):
        return str(value)
    return " ".join(f"{k}={v:g}" if isinstance(v, float) else f"{k}={v}" for k, v in value.items())


def reference_of(model, angles, given):
    return brdf.MODELS[model].albedo(cosines(angles), **given)


FURNACE = [
    *[("disk_scaling", {"exponent": n}) for n in (0.0, 1.0, 5.0, 50.0, 500.0, 5000.0)],
    *[("disk_scaling", {"exponent": n, **shape}) for n in (0.0, 50.0, 5000.0) for shape in (SMALL, THIN)],
    *[("edwards_fit", {**WHITE, "exponent": n, "second_exponent": 2.0 * n + 1.0, "radius": r, "second_radius": 1.0})
      for n, r in ((0.0, 0.3), (5.0, 0.8), (50.0, 0.3), (500.0, 1.0), (5000.0, 0.05))],
    ("edwards_fit", {**WHITE, "exponent": 2.5, "radius": 1.0, "blend": 0.0}),
    ("edwards_fit", {**WHITE, "renormalize": False}),
    ("edwards_fit", {**WHITE, "renormalize": False, "exponent": 500.0, "second_exponent": 0.0}),
    ("disk_orthogonal", {"exponent": 20.0, "radius_u": 0.9, "radius_v": 0.1, "rotation": 0.2}),
    ("disk_orthogonal", {"exponent": 1.0}),
    ("edwards_empirical", {"base_color": 0.5, "retro": 0.4, "exponent": 1.0, "retro_exponent": 5.0, "samples": 8}),
    ("edwards_empirical", {"retro": 0.9, "base_color": (0.9, 0.5, 0.1), "retro_exponent": 500.0, **THIN}),
    ("edwards_empirical", {"vary_exponents": True, "exponent": 5.0, "grazing_exponent": 200.0, "base_color": 0.3}),
    ("reciprocal_disk", {"exponent": 7.0}), ("reciprocal_disk", {"exponent": 150.0, "pumps": 2.0}),
    ("reciprocal_disk", {"exponent": 20.0, "fresnel_type": "schlick", "base_color": (0.9, 0.5, 0.1)}),
]


@pytest.mark.versions_by_shader
@pytest.mark.parametrize("model, given", FURNACE, ids=name_of)
def test_furnace(model, given):
    """Light that lumps lose where they leave the disk is lost, and none else: the paper's invisible sphere."""
    material = create_material(model, **given)
    evaluated = {k: v for k, v in given.items() if k != "samples"}
    measured, noise = albedo_of(material, ANGLES)
    assert_good(measure.compare(measured, reference_of(model, ANGLES, evaluated), noise, FURNACE_BOUND), FURNACE_NOISE)
    if model == "disk_scaling":
        assert np.abs(measured - 1.0).max() <= FURNACE_BOUND + SIGMAS * noise.max()


# Sphere under a sun of no size.

# Of the mean, noise included. Lumps of small exponents end steeply: bells follow that badly, and what is left over is
# grainy. The reciprocal lump is no bell near the normal, where its albedo has a cusp.
SUN_BOUND, STEEP_BOUND, RECIPROCAL_BOUND = 0.015, {0.0: 0.25, 1.0: 0.04}, 0.06
SPHERES = [
    ("disk_scaling", {"exponent": 0.0}, (0.0, 65.0)), ("disk_scaling", {"exponent": 1.0}, (0.0, 65.0)),
    *[("disk_scaling", {"exponent": n}, (0.0, 40.0, 65.0, 80.0)) for n in (5.0, 50.0, 500.0)],
    ("disk_scaling", {"exponent": 50.0, "radius_u": 0.2, "radius_v": 0.2}, (0.0, 65.0)),
    ("edwards_fit", {**WHITE, "exponent": 50.0, "second_exponent": 20.0, "radius": 0.5, "second_radius": 0.5}, (40.0,)),
    ("reciprocal_disk", {"exponent": 50.0}, (0.0, 65.0)),
    ("disk_orthogonal", {"exponent": 50.0, "radius_u": 0.5, "radius_v": 0.5}, (40.0,)),
    ("edwards_empirical", {"base_color": 0.8, "exponent": 50.0, "retro_exponent": 20.0}, (40.0,)),
]


def sphere_of(model, given, suns):
    n = given["exponent"]
    resolution = 24 if n <= 5.0 else 40 if n <= 50.0 else 100
    if given.get("radius_u", 1.0) < 0.5:
        resolution = 100
    total_noise, samples = (TOTAL_NOISE, SUN_SAMPLES) if has_total(model, given) else (np.inf, 2 * SUN_SAMPLES)
    return Sun(create_material(model, **given), lambda view, light: brdf.MODELS[model].evaluate(view, light, **given),
               suns, resolution, total_noise, samples)


def has_total(model, given):
    """Whether the light in total is told apart from the formula's: of what is not grainy."""
    return given["exponent"] >= 50.0 and model != "reciprocal_disk"


@pytest.mark.versions_by_shader
@pytest.mark.parametrize("model, given, suns", SPHERES, ids=name_of)
def test_sphere_under_a_sun(model, given, suns):
    report = sphere_of(model, given, suns)
    reciprocal = model == "reciprocal_disk"
    bound = RECIPROCAL_BOUND if reciprocal else STEEP_BOUND.get(given["exponent"], SUN_BOUND)
    assert report.l1().max() <= bound, report
    if has_total(model, given):
        # Blender stores a mesh's normals in 16 bits, which moves a sharp highlight by a few thousandths of its light.
        total = TOTAL_BOUND if given["exponent"] < 500.0 else 2.0 * TOTAL_BOUND
        assert (np.abs(report.total()) <= total + SIGMAS * report.noise()).all(), report
        assert report.noise().max() <= TOTAL_NOISE, report


@pytest.mark.parametrize("n", [50.0, 500.0])
def test_retroreflection_under_a_headlight(n):
    """A sun and a lamp right beside the camera: what comes back is the lump's, and without it almost nothing does."""
    given = {"base_color": 1.0, "diffuse_color": 0.0, "retro": 1.0, "retro_exponent": n}
    suns = (0.0, 4.0)
    report = Sun(create_material("edwards_empirical", **given),
                 lambda view, light: brdf.MODELS["edwards_empirical"].evaluate(view, light, **given), suns, 32)
    assert report.l1().max() <= 0.02 and np.abs(report.total()).max() <= 0.012, report

    def lit(retro):
        material = create_material("edwards_empirical", **{**given, "retro": retro, "exponent": 200.0})
        lamp = {"energy": 1000.0, "size": 0.2, "shape": "DISK", "distance": 20.0}
        picture = measure.sphere(material, [("AREA", (0.02, 0.0, 1.0), lamp)], samples=16, resolution=32)
        slanted = np.nan_to_num(picture.normal[..., 2], nan=1.0) < 0.7
        return picture.image[picture.covered & slanted].mean()

    assert lit(1.0) > 100.0 * lit(0.0)


LAMP_BOUND, LAMP_NOISE = 0.02, 0.008  # of all light; the reciprocal lump is the grainy one
LIT = [("disk_scaling", {"exponent": 50.0}), ("disk_orthogonal", {"exponent": 50.0}),
       ("reciprocal_disk", {"exponent": 200.0}), ("edwards_empirical", {"exponent": 50.0, "retro_exponent": 50.0}),
       ("edwards_fit", {"exponent": 50.0, "second_exponent": 20.0})]


@pytest.mark.versions_by_shader
@pytest.mark.parametrize("model, given", LIT, ids=name_of)
def test_area_lamp(model, given):
    off, noise = total_under_the_lamp(model, given)
    assert noise <= LAMP_NOISE and abs(off) <= LAMP_BOUND + SIGMAS * noise, f"off by {off}, noise {noise}"


# Single directions: anisotropy, rotation and tangent.

def across_plane(view_deg, turns):
    """Lights in the plane of incidence, beside it, and aslant to both sides: there a turn's sign shows."""
    angles = np.clip(view_deg + np.array([-30.0, -12.0, 0.0, 12.0]), -85.0, 80.0)
    aslant = measure.across_lobe(view_deg - 15.0, (15.0, -15.0))
    return np.concatenate([measure.in_plane(angles), measure.across_lobe(view_deg, turns), aslant])


POINTS = [
    ("disk_scaling", {"exponent": 10.0, "radius_u": 1.0, "radius_v": 0.3, "rotation": 0.0}),
    ("disk_scaling", {"exponent": 10.0, "radius_u": 1.0, "radius_v": 0.3, "rotation": 0.25}),
    ("disk_scaling", {"exponent": 10.0, "radius_u": 1.0, "radius_v": 0.3, "rotation": 0.1}),
    ("disk_orthogonal", {"exponent": 20.0, "radius_u": 0.3, "radius_v": 0.6, "rotation": 0.1}),
    ("edwards_empirical", {"exponent": 20.0, "base_color": 0.8, "retro": 0.3, "retro_exponent": 40.0, **THIN}),
    ("edwards_empirical", {"exponent": 5.0, "base_color": 1.0, "vary_exponents": True, "grazing_exponent": 200.0}),
]


@pytest.mark.parametrize("view_deg", [5.0, 40.0, 70.0])
@pytest.mark.parametrize("model, given", POINTS, ids=name_of)
def test_point_by_point(model, given, view_deg):
    """On a plane about the object's z axis the tangent is the x axis."""
    lights, view = across_plane(view_deg, (4.0, 10.0, 20.0)), view_at(cosines([view_deg]))
    peak = max(rgb(brdf.MODELS[model].evaluate(view, near, **given)).max() * near[0, 2]
               for near in (view * [-1.0, -1.0, 1.0], *[light[None] for light in lights]))
    most = 256 if view_deg < 70.0 else 2048
    measured, noise = directions_of(create_material(model, **given), view_deg, lights, peak, most)
    reference = rgb(brdf.MODELS[model].evaluate(view, lights, **given)) * lights[:, 2:] / peak
    # A lump that leaves the disk is blurred towards the horizon.
    bound = 0.05 if model == "disk_orthogonal" and view_deg == 70.0 else POINT_BOUND
    assert_good(measure.compare(measured, reference, noise, bound), 0.2 * bound)


def test_a_linked_tangent_turns_the_lump():
    given = {"exponent": 10.0, "radius_u": 1.0, "radius_v": 0.3}
    material = create_material("disk_scaling", **given)
    nodes = material.node_tree.nodes
    vector = nodes.new("ShaderNodeCombineXYZ")
    vector.inputs[1].default_value = 1.0
    socket = sockets_of(material)["tangent"]
    material.node_tree.links.new(vector.outputs[0], socket)
    lights, view = across_plane(40.0, (10.0,)), view_at(cosines([40.0]))
    f, noise = measure.goniometer(material, 40.0, lights, samples=256)
    turned = rgb(brdf.MODELS["disk_scaling"].evaluate(view, lights, rotation=0.25, **given))
    straight = rgb(brdf.MODELS["disk_scaling"].evaluate(view, lights, **given))
    cosine = lights[:, 2:] / (turned * lights[:, 2:]).max()
    assert_good(measure.compare(f * cosine, turned * cosine, noise * cosine, POINT_BOUND), POINT_NOISE)
    assert measure.compare(f * cosine, straight * cosine, noise * cosine, POINT_BOUND).verdict == comparison.FAILED


def test_unlinked_the_tangent_runs_around_the_object():
    """On a sphere seen along +x, at points of its equator, the lump's u axis is horizontal."""
    given = {"exponent": 20.0, "radius_u": 1.0, "radius_v": 0.15}
    resolution = 32
    material = create_material("disk_scaling", **given)
    with scene.MeasuringScene(material, scene.BALL, resolution, exact_pixels=True) as place:
        place.look_from((1.0, 0.0, 0.0), 2.0 * (1.0 + 1.0 / resolution))
        place.shine("SUN", (1.0, 0.0, 0.0), energy=scene.SUN_ENERGY, angle=0.0)
        image = place.render(256)
    # Only the picture's axes count: along the tangent, around the z axis, the highlight is long.
    lit = image[..., 0] > 0.05 * image.max()
    rows, columns = np.nonzero(lit)
    spans = sorted((np.ptp(rows) + 1, np.ptp(columns) + 1))
    assert spans[1] > 2 * spans[0], spans
    axis = place_axes_of_z()
    assert (np.ptp(rows) + 1, np.ptp(columns) + 1)[axis] == spans[0]


def place_axes_of_z():
    """The picture's axis, 0 rows or 1 columns, that the object's z axis points along for a camera at +x.

    `MeasuringScene.look_from` turns the camera so that its up is as near +y as can be: z is then sideways.
    """
    return 1


# Reference's own check and planted errors.

def test_ball_sees_what_the_formula_sees():
    lit = measure.local_directions(ball(16), np.array([0.0, 0.0, 1.0]), margin=0.05)
    assert np.allclose(lit.view, lit.light)  # a headlight comes from the viewer


PLANTED = {
    "a wrong lump": ("SPOILT_LUMP(value)", "(value) * (n + 1.3) / (n + 1.0)"),
    "a wrong measure": ("SPOILT_STRETCH(value)", "(value) * (4.0 / 3.6)"),
    "bells too bright": ("SPOILT_BELL(weight)", "1.02 * (weight)"),
    "narrow bells": ("SPOILT_DEVIATION(value)", "0.9 * (value)"),
}


@pytest.mark.parametrize("error", PLANTED)
def test_a_planted_error_is_found(monkeypatch, error):
    plant(monkeypatch, *PLANTED[error])
    given = {"exponent": 5.0}
    if error == "narrow bells":  # what they leave over is made up for: only the noise tells, and it must not be biased
        measured, noise = albedo_of(create_material("disk_scaling", **given), (45.0,))
        assert_good(measure.compare(measured, [1.0], noise, FURNACE_BOUND), FURNACE_NOISE)
        return
    measured, noise = albedo_of(create_material("disk_scaling", **given), (45.0,))
    report = measure.compare(measured, [1.0], noise, FURNACE_BOUND)
    l1 = sphere_of("disk_scaling", given, (65.0,)).l1().max()
    assert report.verdict == comparison.FAILED or l1 > 0.015, (report.error, l1)


@pytest.mark.parametrize("view_deg", [5.0, 80.0])
@pytest.mark.parametrize("model, given", [
    ("disk_scaling", {"exponent": 0.0}),
    ("edwards_empirical", {"base_color": 1.0, "retro": 0.5, "retro_exponent": 0.0}),
    ("edwards_fit", {**WHITE, "exponent": 0.0, "second_exponent": 1e5, "radius": 1.0}),
    ("reciprocal_disk", {"exponent": 1.0, "pumps": 4.0}),
], ids=name_of)
def test_no_sample_is_negative(model, given, view_deg):
    pixels = plane(create_material(model, **given), view_deg, samples=1, resolution=96)
    assert np.isfinite(pixels).all() and pixels.min() >= 0.0
    sunny = plane(create_material(model, **given), view_deg, samples=1, resolution=64, sky=0.0, arrange=lambda place:
                  place.shine("SUN", measure.in_plane([view_deg])[0], energy=scene.SUN_ENERGY, angle=0.0))
    assert np.isfinite(sunny).all() and sunny.min() >= 0.0


@pytest.mark.parametrize("name, wild", [
    ("exponent", np.nan), ("exponent", np.inf), ("exponent", -3.0), ("radius_u", 0.0), ("radius_u", np.nan),
    ("radius_v", 1e9), ("rotation", np.nan), ("samples", 1000), ("light_spread", np.nan),
])
def test_a_socket_out_of_range_renders_numbers(name, wild):
    material = create_material("disk_scaling")
    sockets_of(material)[name].default_value = wild
    pixels = plane(material, 60.0, samples=16)
    assert np.isfinite(pixels).all() and pixels.min() >= 0.0
    assert pixels.mean() == pytest.approx(1.0, abs=0.02)  # held on the disk, whatever it is
