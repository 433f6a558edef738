"""The demo scene, headless and tiny: its six panels exist and show what they are for. Figures: `plausible figures`."""
import math

import numpy as np
import pytest

from addon.dev.demo import shapes

pytestmark = pytest.mark.blender
RESOLUTION = (64, 48)


def test_rounded_outline_stays_within_its_corners():
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    outline = shapes.rounded(square, 0.2)
    assert outline.min() >= 0.0 and outline.max() <= 1.0
    np.testing.assert_allclose(outline[[0, -1]], [square[0], square[-1]])
    # The corner itself is cut away, by less than the radius' share of a sharp corner.
    nearest = np.linalg.norm(outline - [1.0, 0.0], axis=1).min()
    assert 0.05 < nearest < 0.2
    with pytest.raises(ValueError, match="coincide"):
        shapes.rounded([(0.0, 0.0), (0.0, 0.0), (1.0, 0.0)], 0.1)


def _volume(vertices, faces):
    """Signed volume of a closed mesh: positive where every face looks outwards."""
    points = np.asarray(vertices, dtype=np.float64)
    return sum(np.dot(points[f[0]], np.cross(points[f[i]], points[f[i + 1]])) / 6.0
               for f in faces for i in range(1, len(f) - 1))


@pytest.mark.parametrize(("shape", "volume"), [
    (shapes.lathe([(0.0, 0.0), (0.5, 0.0), (0.5, 2.0), (0.0, 2.0)], 256), math.pi * 0.25 * 2.0),
    (shapes.prism([(-1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (-1.0, 1.0)], 0.5), 1.0),
    (shapes.prism(shapes.stadium(3.0, 1.0, 128), 1.0), 2.0 + math.pi / 4.0),
    (shapes.pyramid(2.0, 3.0), 4.0),
])
def test_bodies_are_closed_and_look_outwards(shape, volume):
    vertices, faces = shape
    edges = [edge for face in faces for edge in zip(face, face[1:] + face[:1], strict=True)]
    assert len(set(edges)) == len(edges) and {(b, a) for a, b in edges} == set(edges)
    assert _volume(vertices, faces) == pytest.approx(volume, rel=1e-3)


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    """The folder, the panels as stem -> (height, width, 3) linear, first row at the top, and the floor's N·V."""
    pytest.importorskip("bpy")
    import bpy

    from addon.dev.demo import panels

    folder = tmp_path_factory.mktemp("demo")
    lines = []
    paths = panels.render_all(folder, RESOLUTION, samples=48, report=lines.append)
    assert len(lines) == len(paths) == 6
    loaded = {}
    for path in paths:
        assert path.exists()
        image = bpy.data.images.load(str(path.with_suffix(".exr")))
        pixels = np.array(image.pixels[:]).reshape(image.size[1], image.size[0], -1)
        loaded[path.stem] = pixels[::-1, :, :3]
    return folder, loaded, _floor_cosines(bpy.context.scene)


def _floor_cosines(scene):
    """N·V (height, width) where a pixel's centre sees the floor, 0 elsewhere."""
    import bpy
    from mathutils import Vector

    camera, graph = scene.camera, bpy.context.evaluated_depsgraph_get()
    width, height = RESOLUTION
    corners = [camera.matrix_world.to_3x3() @ corner for corner in camera.data.view_frame(scene=scene)]
    right, down = corners[0] - corners[3], corners[2] - corners[3]
    cosine = np.zeros((height, width))
    for y, x in np.ndindex(height, width):
        ray = Vector(corners[3] + right * ((x + 0.5) / width) + down * ((y + 0.5) / height)).normalized()
        hit, *_, body, _ = scene.ray_cast(graph, camera.location, ray)
        if hit and body.name == "Floor":
            cosine[y, x] = -ray.z
    return cosine


def test_every_panel_is_finite_and_lit(pictures):
    from addon.dev.demo import panels

    _, loaded, _ = pictures
    assert list(loaded) == [panel.stem for panel in panels.panels()]
    for pixels in loaded.values():
        assert pixels.shape == (RESOLUTION[1], RESOLUTION[0], 3)
        assert np.isfinite(pixels).all() and pixels.min() >= 0.0
        # The sky fills the top and is the same in every panel.
        np.testing.assert_allclose(pixels[1].mean(axis=0), [0.82, 0.84, 0.85], atol=0.05)


@pytest.mark.parametrize("exponent", [20.0, 5000.0])
@pytest.mark.parametrize("row", ["pumped", "controlled"])
def test_pumping_lights_the_floor_where_it_is_seen_at_grazing(pictures, row, exponent):
    """Floor seen at 76 to 84 degrees: brighter by about what the albedos at 80 degrees say for a uniform sky.

    The sky is brighter at the horizon and the pyramids stand in the mirror's way, hence the wide bounds.
    """
    from addon.brdf import MODELS

    _, loaded, cosine = pictures
    grazing = (cosine > math.cos(math.radians(84.0))) & (cosine < math.cos(math.radians(76.0)))
    assert grazing.sum() > 40
    plain, pumped = (float(np.median(loaded[f"{stem}_n{exponent:g}"][grazing] @ [0.2126, 0.7152, 0.0722]))
                     for stem in ("phong", row))
    given = {"pumped": {"pumps": 1.0, "control": False}, "controlled": {"pumps": 2.0, "control": True}}[row]
    at_80 = np.cos(np.radians([80.0]))
    expected = float((MODELS["pumped_phong"].albedo(at_80, exponent=exponent, **given)
                      / MODELS["phong"].albedo(at_80, exponent=exponent))[0])
    assert 0.85 * expected < pumped / plain < 1.3 * expected
    assert 0.15 < pumped < 0.6  # nickel's reflectance of 0.65 times a sky of up to 0.93


def test_contact_sheet_holds_the_panels_pixel_for_pixel(pictures, tmp_path):
    image = pytest.importorskip("matplotlib.image")
    from addon.dev.demo import panels, sheet

    folder, *_ = pictures
    paths = [folder / f"{panel.stem}.png" for panel in panels.panels()]
    sheet.compose(paths, [p.caption for p in panels.panels()], 2, "Title", "Note", tmp_path / "sheet.png")
    pixels = image.imread(tmp_path / "sheet.png")[..., :3]
    width, height = RESOLUTION
    left, top = sheet.MARGIN + width + sheet.GAP, sheet.HEAD + height + sheet.CAPTION + sheet.GAP
    np.testing.assert_allclose(pixels[top:top + height, left:left + width], image.imread(paths[3])[..., :3], atol=1e-6)


def test_saved_scene_is_small_and_knows_no_path(pictures, tmp_path):
    import bpy

    from addon.blender.backend import osl
    from addon.blender.material import groups
    from addon.dev.demo import panels, scene

    stage = scene.build(RESOLUTION)
    panels.prepare(stage, 4)
    panels.dress(stage, panels.panels()[-1])
    path = tmp_path / "scene.blend"
    scene.save(stage, path)
    assert path.stat().st_size < 4_000_000
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert {"Hull", "Turret", "Pyramid copper", "Floor"} <= set(bpy.data.objects.keys())
    assert bpy.context.scene.render.filepath == "//"
    assert not bpy.data.libraries and not bpy.data.images
    hull = bpy.data.objects["Hull"].active_material
    node = osl.script_of(groups.find_node(hull))
    assert node.bytecode.startswith("OpenShadingLanguage") and "/" not in node.bytecode.split("code ___main___")[0]
    assert str(tmp_path) not in node.bytecode and "plausible_" not in node.bytecode
    panels.prepare(stage := scene.Stage(bpy.context.scene, {}), 2)
    stage.scene.render.filepath = str(tmp_path / "again.png")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(tmp_path / "again.png"))
    assert 0.3 < np.mean(np.array(image.pixels[:]).reshape(-1, 4)[:, :3]) < 0.9


def test_presets_are_cut_into_tiles(tmp_path, monkeypatch):
    """Of three, in two rows: each has its colour in the middle and the ground in its corners."""
    pytest.importorskip("bpy")
    image = pytest.importorskip("matplotlib.image")
    from addon.dev.demo import presets
    from addon.library.presets import PRESETS

    names = ("gold_polished", "coated_plastic", "glossy_plastic")
    monkeypatch.setattr(presets, "PRESETS", {name: PRESETS[name] for name in names})
    monkeypatch.setattr(presets, "COLUMNS", 2)
    paths = presets.render_all(tmp_path, (24, 24), 8)
    assert [path.name for path in paths] == [f"preset_{name}.png" for name in names]
    assert presets.captions() == ["Gold, Polished", "Coated Plastic", "Glossy Plastic"]
    gold, blue, red = (image.imread(path)[..., :3] for path in paths)
    for tile in (gold, blue, red):
        assert tile.shape == (24, 24, 3)
        np.testing.assert_allclose(tile[[0, 0, -1, -1], [0, -1, 0, -1]], [presets.GROUND] * 4, atol=0.005)
    middle = [tile[6:18, 6:18].mean(axis=(0, 1)) for tile in (gold, blue, red)]
    assert middle[0][0] > middle[0][1] > middle[0][2]
    assert middle[1].argmax() == 2 and middle[2].argmax() == 0


@pytest.mark.parametrize("text", ["", "480", "480x", "x360", "3x3", "480x-1", "axb"])
def test_resolution_that_is_none_is_refused(text, capsys):
    from addon import cli

    with pytest.raises(SystemExit):
        cli.main(["demo", "--resolution", text])
    assert "resolution" in capsys.readouterr().err


def test_figures_are_written_as_png_and_svg(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    from addon import cli
    from addon.dev.figures import pumping

    assert cli.main(["figures", "pumping", "--output", str(tmp_path)]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 2 * len(pumping.SET)
    assert {p.name for p in tmp_path.iterdir()} == {f"pumping_{n}.{e}" for n in pumping.SET for e in ("png", "svg")}
    assert cli.main(["figures", "nothing"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_figures_show_the_papers_values():
    from addon.dev.figures import pumping

    angles, albedo = pumping.albedo_curve("pumped_phong", exponent=20.0, pumps=0.0)
    np.testing.assert_allclose(np.interp([40.0, 60.0, 80.0], angles, albedo), [0.7660, 0.5005, 0.2004], atol=5e-4)
    # The peak is N·L times (n+2)/(2 pi), in the mirror direction.
    for light in (0.0, 40.0):
        angles, radiance = pumping.radiance_curve("phong", light, exponent=20.0)
        assert angles[np.argmax(radiance)] == pytest.approx(light, abs=0.3)
        assert radiance.max() == pytest.approx(22.0 / (2.0 * math.pi) * math.cos(math.radians(light)), rel=1e-3)
