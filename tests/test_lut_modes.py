"""Albedo tables compiled into the shader and read from files: the same picture, and no silence about a bad file."""
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from blender_help.materials import use_table
from optics.plane import picture

from addon import create_material
from addon.backends.osl import estimator
from addon.brdf import MODELS
from addon.forms.albedo import tables
from addon.models import exr

pytestmark = pytest.mark.blender

ROOT = Path(__file__).resolve().parents[1]
PUMPED = ("pumped_phong", "pumped_blinn")
# Interpreters of other Blenders, separated as in PATH, to render what this one saved.
OTHERS = [path for path in os.environ.get("PLAUSIBLE_OTHER_PYTHON", "").split(os.pathsep) if path]


@pytest.mark.versions_by_shader
@pytest.mark.parametrize("exponent, typical", [(1.0, 1e-5), (20.0, 1e-5), (3000.0, 1e-4), (100000.0, 1e-3)])
@pytest.mark.parametrize("control", [False, True], ids=["plain", "controlled"])
@pytest.mark.parametrize("model", PUMPED)
def test_files_render_what_compiled_tables_render(model, control, exponent, typical):
    """Of equal seeds, pixel by pixel: what differs is how the numbers were read.

    The last digit of a weight decides now and then which closure a path follows, and the pixel it belongs to is
    another one then: so the typical pixel, and all of them together. The sharpest lobes lose digits everywhere.
    """
    for view_deg in (30.0, 80.0):
        compiled, file = (picture(create_material(model, lut=lut, exponent=exponent, pumps=2.5, control=control),
                                  view_deg) for lut in ("compiled", "file"))
        difference = (file - compiled)[:, 0]
        assert compiled.mean() > 0.1
        assert np.median(np.abs(difference)) < typical
        assert abs(difference.mean()) < 1e-4 + 5.0 * difference.std() / np.sqrt(len(difference))
        assert difference.std() < 0.02


@pytest.mark.versions
@pytest.mark.parametrize("model, given", [
    ("edwards_fit", {"base_color": 1.0, "exponent": 0.0, "second_exponent": 5000.0, "second_radius": 0.05}),
    ("edwards_fit", {"base_color": 1.0, "exponent": 5.0, "second_exponent": 20.0, "radius": 1.0}),
    ("reciprocal_disk", {"exponent": 1.0, "pumps": 2.5}),
    ("reciprocal_disk", {"exponent": 200.0, "pumps": 1.0}),
])
def test_files_of_the_disk_render_what_compiled_tables_render(model, given):
    for view_deg in (1.0, 30.0, 80.0):
        compiled, file = (picture(create_material(model, lut=lut, **given), view_deg) for lut in ("compiled", "file"))
        difference = (file - compiled)[:, 0]
        assert compiled.mean() > 0.1
        assert np.median(np.abs(difference)) < 1e-5
        assert abs(difference.mean()) < 1e-4 + 5.0 * difference.std() / np.sqrt(len(difference))


@pytest.mark.versions
@pytest.mark.parametrize("model, mode", [("edwards_fit", "volume"), ("reciprocal_disk", "plain")])
def test_a_bad_file_of_the_disk_is_told(model, mode, tmp_path, capfd):
    from addon.blender.material import groups, sockets

    material = create_material(model, lut="file")
    socket = sockets.by_id(groups.find_node(material))[f"table_{mode}"]
    socket.default_value = str(tmp_path / "gone.exr")
    capfd.readouterr()
    pixels = picture(material, 5.0, 1)
    assert np.array_equal(pixels[:, 0], pixels[:, 2]) and not pixels[:, 1].any()
    assert "gone.exr" in "".join(capfd.readouterr())


def missing(good, folder):
    return folder / "gone.exr"


def nameless(good, folder):
    return ""


def truncated(good, folder):
    data = good.read_bytes()
    (folder / "half.exr").write_bytes(data[: len(data) // 2])
    return folder / "half.exr"


def no_image(good, folder):
    (folder / "letter.exr").write_text("Dear renderer")
    return folder / "letter.exr"


def other_image(good, folder):
    exr.write(folder / "grey.exr", np.full((64, 128, 4), 0.5, np.float32), {})
    return folder / "grey.exr"


def other_table(good, folder):
    other = next(t for t in tables.TABLES.values() if t.path.name != good.name)
    shutil.copyfile(other.path, folder / other.path.name)
    return folder / other.path.name


def stale(good, folder):
    """A table whose axes were another version's: its markers hold another stamp."""
    image, metadata = exr.read(good)
    image = np.array(image)
    image[[0, -1], :, 1] += 1e-4
    exr.write(folder / "stale.exr", image, {})
    return folder / "stale.exr"


@pytest.mark.versions
@pytest.mark.parametrize("spoil", [missing, nameless, truncated, no_image, other_image, other_table, stale])
@pytest.mark.parametrize("control", [False, True], ids=["plain", "controlled"])
def test_a_bad_file_is_told_in_picture_and_words(spoil, control, tmp_path, capfd):
    good = tables.TABLES["phong_controlled" if control else "phong_plain"].path
    path = spoil(good, tmp_path)
    material = create_material("pumped_phong", lut="file", control=control)
    use_table(material, control, path)
    capfd.readouterr()
    for pixels in (picture(material, 5.0, 1), picture(material, 5.0, 1, energy=np.pi)):
        assert np.array_equal(pixels[:, 0], pixels[:, 2]) and not pixels[:, 1].any()
        black = pixels[:, 0] == 0.0
        assert 0.2 < black.mean() < 0.8, "stripes"
        assert pixels[~black, 0].min() > 0.5
    said = capfd.readouterr().err
    assert "Plausible BRDF: albedo table" in said and str(path) in said


@pytest.mark.versions
def test_a_bad_file_of_the_other_kind_does_not_matter(tmp_path):
    """A controlled material does not read the plain table, nor an unpumped one either."""
    material = create_material("pumped_phong", lut="file", control=True)
    use_table(material, False, tmp_path / "gone.exr")
    assert picture(material)[:, 1].mean() > 0.8
    unpumped = create_material("pumped_phong", lut="file", pumps=0.0)
    use_table(unpumped, True, tmp_path / "gone.exr")
    assert picture(unpumped)[:, 1].mean() > 0.4


@pytest.mark.versions
def test_a_mended_file_is_read_again(tmp_path):
    material = create_material("pumped_phong", lut="file")
    good = tables.TABLES["phong_controlled"].path
    use_table(material, True, tmp_path / "gone.exr")
    assert not picture(material)[:, 1].any()
    use_table(material, True, good)
    assert picture(material)[:, 1].mean() > 0.8


WRITER = """
import sys
sys.path.insert(0, sys.argv[1])
import bpy
from addon import create_material
made = {create_material(model, name=model) for model in sys.argv[3:]}
bpy.data.libraries.write(sys.argv[2], made, fake_user=True)
print("RESULT", list(bpy.app.version), flush=True)
"""
READER = """
import sys, json
sys.path.insert(0, sys.argv[1])
import bpy
with bpy.data.libraries.load(sys.argv[2]) as (_, wanted):
    wanted.materials = sys.argv[3:]
from addon.measure import scene
shown = {}
for material in wanted.materials:
    with scene.MeasuringScene(material, scene.PLANE, 16) as place:
        place.sky(1.0)
        place.look_from((0.6, 0.0, 0.8))
        for samples in (64, 256, 1024):
            pixels = place.render(samples).reshape(-1, 3)
            shown[material.name] = pixels.mean(), pixels.std() / len(pixels) ** 0.5
            if shown[material.name][1] < 7e-4:
                break
print("RESULT", json.dumps(shown), flush=True)
"""


def run_in(python, script, *arguments):
    """What a script printed after RESULT in another interpreter, read as JSON."""
    # Blender names its own colour configuration in OCIO, which another version cannot read.
    environment = {key: value for key, value in os.environ.items() if key != "OCIO"}
    done = subprocess.run([python, "-c", script, str(ROOT), *map(str, arguments)], capture_output=True, text=True,
                          timeout=300, env=environment)
    lines = [line for line in done.stdout.splitlines() if line.startswith("RESULT")]
    assert lines, done.stderr
    return json.loads(lines[0].removeprefix("RESULT"))


if OTHERS:  # nothing to test, and nothing to skip, where there is one Blender only
    @pytest.mark.versions
    @pytest.mark.parametrize("python", OTHERS)
    def test_the_newer_version_renders_what_the_older_saved(python, tmp_path):
        # Not the other way: files of 5.x are closed to 4.2.
        models = [name for name, model in MODELS.items() if not estimator.is_baked(model)] + ["cook_torrance"]
        files = {p: tmp_path / f"{i}.blend" for i, p in enumerate((sys.executable, python))}
        older = min(files, key=lambda p: run_in(p, WRITER, files[p], *models))
        here, there = (run_in(p, READER, files[older], *models) for p in files)
        assert set(here) == set(there) == set(models)
        for model in models:
            (value, noise), (other, other_noise) = here[model], there[model]
            assert max(noise, other_noise) < 7e-4, model
            assert abs(value - other) < 5e-4 + 5.0 * (noise**2 + other_noise**2) ** 0.5, model
