"""The disk paper's demo scenes, headless and tiny: spheres, a road whose signs shine only as retroreflectors, and
white spheres in a furnace."""
from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.blender
BLENDS = Path(__file__).resolve().parents[1] / "demo_blends"
FACES = ["Limit face", "Bend face", "Guide face", "Chevron face"]
LUMINANCE = [0.2126, 0.7152, 0.0722]


def _pixels(png):
    """Linear radiance (height, width, 3) of the EXR beside a PNG, first row at the top."""
    import bpy

    assert png.is_file()
    image = bpy.data.images.load(str(png.with_suffix(".exr")))
    pixels = np.array(image.pixels[:]).reshape(image.size[1], image.size[0], -1)
    bpy.data.images.remove(image)
    return pixels[::-1, :, :3]


def _boxes(scene, resolution, names):
    """name -> (rows, columns), slices of the pixels that the objects whose names begin so may cover."""
    import bpy
    from bpy_extras.object_utils import world_to_camera_view
    from mathutils import Vector

    bpy.context.view_layer.update()
    boxes = {}
    for name in names:
        corners = [world_to_camera_view(scene, scene.camera, body.matrix_world @ Vector(corner))
                   for body in scene.objects if body.name.startswith(name) and body.type == "MESH"
                   for corner in body.bound_box]
        low, high = np.min(corners, axis=0)[:2], np.max(corners, axis=0)[:2]
        assert (low > 0.0).all() and (high < 1.0).all()
        (left, bottom), (right, top) = low * resolution, high * resolution
        height = resolution[1]
        boxes[name] = slice(int(height - top), int(height - bottom) + 1), slice(int(left), int(right) + 1)
    return boxes


@pytest.fixture(scope="module")
def road(tmp_path_factory):
    """Pixels of the diffuse and of the retroreflective road, and the boxes of its signs and their faces."""
    bpy = pytest.importorskip("bpy")
    from addon.dev.demo import road

    resolution, lines = (128, 80), []
    paths = road.render_all(tmp_path_factory.mktemp("road"), resolution, samples=16, report=lines.append)
    assert len(lines) == len(paths) == len(road.captions()) == 2
    return [_pixels(path) for path in paths], _boxes(bpy.context.scene, resolution, FACES)


def test_the_road_is_finite_and_lit(road):
    for pixels in road[0]:
        assert pixels.shape == (80, 128, 3)
        assert np.isfinite(pixels).all() and pixels.min() >= 0.0
        assert pixels.mean() > 0.01


@pytest.mark.parametrize("name", FACES)
def test_signs_shine_as_retroreflectors_only(road, name):
    """By what the formula says of the lump of exponent 60 for lamps within 5 degrees of the eye: about 10 times."""
    (diffuse, retro), boxes = road
    dim, bright = (float(np.mean(pixels[boxes[name]] @ LUMINANCE)) for pixels in (diffuse, retro))
    assert 4.0 * dim < bright < 20.0 * dim


def test_markings_shine_far_ahead_and_the_asphalt_does_not(road):
    (diffuse, retro), _ = road
    difference = (retro - diffuse) @ LUMINANCE
    rows = difference[50:]  # the road before the bend
    assert (rows.max(axis=1) > 0.05).all()
    assert np.median(np.abs(rows)) < 0.003


def test_the_ways_along_the_road_are_metres():
    pytest.importorskip("bpy")
    from addon.dev.demo import road

    way = np.array([road.centre(s) for s in np.arange(0.0, road.ROAD_END, 1.0)])
    np.testing.assert_allclose(np.linalg.norm(np.diff(way, axis=0), axis=1), 1.0, rtol=0.01)
    for s in (10.0, 80.0):
        across = np.subtract(road.centre(s, 1.0), road.centre(s))
        along = np.subtract(road.centre(s + 0.01), road.centre(s))[:2]
        assert np.dot(across[:2], along) == pytest.approx(0.0, abs=1e-5)
        assert along[0] * across[1] - along[1] * across[0] < 0.0  # to the right


@pytest.fixture(scope="module")
def spheres(tmp_path_factory):
    """Pixels of the spheres' picture and each sphere's box."""
    bpy = pytest.importorskip("bpy")
    from addon.dev.demo import spheres

    resolution = (160, 120)
    paths = spheres.render_all(tmp_path_factory.mktemp("spheres"), resolution, samples=6)
    assert len(paths) == len(spheres.captions()) == 1
    names = [f"Sphere {sphere.label}" for row in spheres.rows() for sphere in row]
    return _pixels(paths[0]), _boxes(bpy.context.scene, resolution, names)


def test_the_spheres_are_finite_and_lit(spheres):
    pixels, boxes = spheres
    assert pixels.shape == (120, 160, 3)
    assert np.isfinite(pixels).all() and pixels.min() >= 0.0
    assert len(boxes) == 15
    for box in boxes.values():
        assert min(pixels[box].shape[:2]) >= 16
        assert 0.03 < np.mean(pixels[box] @ LUMINANCE) < 2.0


def _belt(pixels, box):
    """Share of a sphere's contrast that runs up and down, 0..1, in the square within it: 1 for level belts."""
    light = np.log(pixels[box] @ LUMINANCE + 0.01)
    rim_y, rim_x = (round(0.15 * n) for n in light.shape)
    inner = light[rim_y:-rim_y, rim_x:-rim_x]
    down, across = inner.mean(axis=1).var(), inner.mean(axis=0).var()
    return down / (down + across)


def test_highlights_turn_with_the_lump(spheres):
    """Along the tangent, which runs around an upright axis, a lump of small Radius V smears all into level belts."""
    pixels, boxes = spheres
    belts = {label: _belt(pixels, boxes[f"Sphere {label}"])
             for label in ("v = 1", "v = 0.02", "turn 0°", "turn 90°", "upright")}
    assert min(belts["v = 0.02"], belts["upright"]) > 0.8
    assert belts["v = 1"] < belts["v = 0.02"] - 0.05  # the sky alone runs up and down, too
    assert belts["turn 90°"] < belts["turn 0°"] - 0.1


@pytest.fixture(scope="module")
def furnace(tmp_path_factory):
    """label -> (radiance (N,) over the background's, distance (N,) from the centre in radii) of a sphere's pixels."""
    pytest.importorskip("bpy")
    from addon.dev.demo import furnace

    resolution = (240, 120)
    paths = furnace.render_all(tmp_path_factory.mktemp("furnace"), resolution, samples=16)
    assert len(paths) == len(furnace.captions()) == 1
    pixels = _pixels(paths[0]) @ LUMINANCE / furnace.BACKGROUND
    np.testing.assert_allclose(pixels[:, :3], 1.0, atol=1e-4)
    scale = resolution[0] / furnace.VIEW_WIDTH
    rows, columns = np.mgrid[:resolution[1], :resolution[0]] + 0.5
    found = {}
    for index, sphere in enumerate(furnace.SPHERES):
        x, z = furnace.COLUMNS[index % 4] * scale, furnace.ROWS[index // 4] * scale
        away = np.hypot(columns - 0.5 * resolution[0] - x, rows - 0.5 * resolution[1] + z) / (furnace.RADIUS * scale)
        found[sphere.label] = pixels[away < 1.0], away[away < 1.0]
    return found


@pytest.mark.parametrize("label", ["Edwards fit, renormalized", "Edwards empirical"])
def test_spheres_that_conserve_energy_are_invisible(furnace, label):
    pixels, away = furnace[label]
    for where in (away < 1.0, away < 0.5, away > 0.8):
        assert pixels[where].mean() == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize(("label", "distance"), [
    ("Ward", (0.5, 0.7)), ("Ashikhmin-Shirley", (0.25, 0.45)), ("Blinn-Phong", (0.6, 0.9)),
    ("Cook-Torrance", (0.05, 0.12)), ("Edwards fit, raw", (0.35, 0.6))])
def test_the_others_are_dark_at_the_rim(furnace, label, distance):
    pixels, away = furnace[label]
    rim = pixels[(away > 0.85) & (away < 0.95)]
    assert distance[0] < 1.0 - rim.mean() < distance[1]


def test_blinns_sphere_makes_light_in_the_middle(furnace):
    pixels, away = furnace["Blinn-Phong"]
    assert 1.02 < pixels[away < 0.2].mean() < 1.08


def test_the_reciprocal_lump_loses_light_only_in_the_middle(furnace):
    pixels, away = furnace["Reciprocal disk, pumped"]
    assert 0.8 < pixels[away < 0.15].mean() < 0.95
    assert pixels[away > 0.7].mean() == pytest.approx(1.0, abs=0.01)


def _check_blend(path, names):
    """The file at `path` holds objects of these names, and needs nothing beside it."""
    import bpy

    from addon.blender.backend import osl
    from addon.blender.material import groups

    assert path.stat().st_size < 3_000_000
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert set(names) <= set(bpy.data.objects.keys())
    assert bpy.context.scene.cycles.shading_system and bpy.context.scene.render.filepath == "//"
    assert not bpy.data.libraries
    for image in bpy.data.images:
        assert image.packed_file and image.filepath.startswith("//")
    ours = [node for node in map(groups.find_node, bpy.data.materials) if node is not None]
    assert ours
    for script in map(osl.script_of, ours):
        assert script.bytecode.startswith("OpenShadingLanguage")
        assert "/" not in script.bytecode.split("code ___main___")[0]
    return len(ours)


@pytest.mark.parametrize(("module", "blend", "names", "count"), [
    ("spheres", "disk_spheres.blend", ["Sphere brushed", "Step 1", "Camera"], 15),
    ("road", "night_road.blend", ["Limit face", "Road", "Headlight", "Camera"], 5),
    ("furnace", "invisible_spheres.blend", ["Sphere Ward", "Label Edwards empirical", "Camera"], 8),
    ("reflector", "light_points.blend", ["Reflector", "Lamp", "Camera"], 1),
])
def test_blends_need_nothing_beside_them(module, blend, names, count, tmp_path):
    import importlib

    bpy = pytest.importorskip("bpy")
    assert _check_blend(BLENDS / blend, names) == count
    fresh = tmp_path / blend
    importlib.import_module(f"addon.dev.demo.{module}").save_blend(fresh, (48, 32), 2)
    assert [path.name for path in tmp_path.iterdir()] == [blend]
    assert _check_blend(fresh, names) == count
    scene = bpy.context.scene
    scene.render.image_settings.file_format = "PNG"
    scene.render.filepath = str(tmp_path / "again.png")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(tmp_path / "again.png"))
    assert np.mean(np.array(image.pixels[:]).reshape(-1, 4)[:, :3]) > 0.03


@pytest.mark.versions
@pytest.mark.parametrize("blend", sorted(path.name for path in BLENDS.glob("*.blend")))
def test_each_version_opens_the_blends(blend):
    """They are saved by the oldest: what newer ones save is closed to it."""
    import bpy

    bpy.ops.wm.open_mainfile(filepath=str(BLENDS / blend))
    assert bpy.context.scene.camera and bpy.context.scene.cycles.shading_system
    assert bpy.data.version[:2] == (4, 2), "save it by Blender 4.2: ./run demo all --save-blend"


def test_one_file_for_all_scenes_is_refused(capsys, tmp_path):
    from addon import cli

    assert cli.main(["demo", "all", "--save-blend", str(tmp_path / "all.blend")]) == 2
    assert "one file" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        cli.main(["demo", "moon"])
    assert "moon" in capsys.readouterr().err
