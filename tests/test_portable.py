"""A material is self-contained: alone, linked, appended, moved and packed, a .blend renders the same bits."""
import importlib.metadata
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from addon import cli
from addon.forms.albedo import tables
from addon.portability import portable

ROOT = Path(__file__).resolve().parents[1]
LIBRARY = Path("lib dir") / "möbel ü.blend"
USERS = ("linked.blend", "appended.blend", "moved/deep down/linked.blend")

# One process saves all that is rendered here: a scene, and files that link and append it out of a read-only folder.
_BUILD = """
import os, sys
from pathlib import Path
import bpy
from blender_help import portable_scene as scene

folder, library = Path(sys.argv[1]), Path(sys.argv[2])
scene.build()
scene.save(library)
library.chmod(0o444)
library.parent.chmod(0o555)
for name, link in (("appended.blend", False), ("linked.blend", True)):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene.save(folder / name)
    scene.bring(library, link)
    scene.save(folder / name, compress=True)
assert bpy.data.libraries[0].filepath == "//lib dir/möbel ü.blend", bpy.data.libraries[0].filepath
# Absolute, made relative, and saved elsewhere: Blender adapts the paths that it knows of.
bpy.data.libraries[0].filepath = str(library)
bpy.ops.file.make_paths_relative()
scene.save(folder / "moved" / "deep down" / "linked.blend")
assert bpy.data.libraries[0].filepath == "//../../lib dir/möbel ü.blend", bpy.data.libraries[0].filepath
scene.build_needy(library, folder)
scene.save(folder / "needy.blend")
sys.stdout.flush()
os._exit(0)
"""
# Another renders them, as `plausible portable` does: it knows nothing of the extension.
_RENDER = """
import os, sys
sys.path.insert(0, sys.argv[1])
import probe
for blend, pixels in zip(sys.argv[2::2], sys.argv[3::2]):
    found = probe.main({"blend": blend, "pixels": pixels, "result": pixels + ".json", "frame": None, "size": 96,
                            "samples": 8, "alone": True})
    assert "error" not in found, found
sys.stdout.flush()
os._exit(0)
"""


def run(script, *arguments):
    """What a script prints in a Blender of its own that finds the extension and this folder's modules."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "tests"))),
                   "OPENBLAS_NUM_THREADS": "1"}  # more of them bake no faster, but take four times the processor
    done = subprocess.run([sys.executable, "-c", script, *map(str, arguments)], capture_output=True, text=True,
                          env=environment, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def pictures(folder, files):
    """What each of the .blend `files` renders in its place."""
    names = [str(folder / f"{i}.npy") for i in range(len(files))]
    run(_RENDER, ROOT / "addon" / "portability", *(x for pair in zip(files, names, strict=True) for x in pair))
    return [np.load(name) for name in names]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the scene in LIBRARY, the files that use it, and one that lacks much."""
    folder = tmp_path_factory.mktemp("portable")
    run(_BUILD, folder, folder / LIBRARY)
    yield folder
    (folder / LIBRARY).parent.chmod(0o755)


@pytest.fixture(scope="module")
def original(folder):
    """The journey of the scene."""
    return portable.travel(folder / LIBRARY, sys.executable)


@pytest.mark.blender
@pytest.mark.versions
def test_alone_it_renders_identically(original):
    assert original.error == "" and original.findings == [] and original.written == []
    assert original.identical and portable.difference(original.in_place, original.alone).pixels == 0
    # There is something to see: a grey sky, and in each third of the picture a sphere with the sun in it.
    assert original.alone.shape == (32, 96, 4)
    for third in np.split(original.alone[..., :3], 3, axis=1):
        np.testing.assert_allclose(third[0].mean(axis=0), (0.4, 0.5, 0.6), rtol=1e-3)
        assert third.max() > 1.0


@pytest.mark.blender
@pytest.mark.versions
def test_linked_appended_and_moved_it_renders_identically(folder, original, tmp_path):
    for picture in pictures(tmp_path, [folder / name for name in USERS]):
        assert picture.tobytes() == original.in_place.tobytes(), portable.difference(original.in_place, picture)
    assert not [path for path in (folder / LIBRARY).parent.iterdir() if path.name != LIBRARY.name]


@pytest.mark.blender
@pytest.mark.versions
def test_what_would_be_missing_is_named(folder, capsys, monkeypatch):
    journey = portable.travel(folder / "needy.blend", sys.executable, size=16, samples=1)
    monkeypatch.setattr(portable, "travel", lambda *arguments: journey)
    call = ["portable", str(folder / "needy.blend")]
    assert cli.main([*call, "--json"]) == 1
    report = json.loads(capsys.readouterr().out)
    assert not report["portable"] and not report["journeys"][0]["identical"] and not report["journeys"][0]["error"]
    found = {(f["subject"], Path(f["path"]).name): f for f in report["findings"]}
    present = tables.TABLES["phong_controlled"].path.name
    grave = {("material 'Tables'", "gone.exr"): "which is missing already", ("material 'Tables'", present): "BAT",
             ("material 'Outside'", "metal.osl"): "EXTERNAL",
             ("image 'wood.png'", "wood.png"): "pack it", ("library 'möbel ü.blend'", LIBRARY.name): "a file outside",
             ("scene 'Scene'", ""): "GPU", ("scene 'No OSL'", ""): "Open Shading Language is off"}
    light = {("material 'Image'", "star.png"): "not needed to render", ("scene 'Workbench'", ""): "BLENDER_WORKBENCH"}
    assert set(found) == set(grave) | set(light)
    for key, words in {**grave, **light}.items():
        assert words in found[key]["text"] and found[key]["grave"] == (key in grave), found[key]
    assert found["material 'Tables'", present]["exists"] and not found["material 'Tables'", "gone.exr"]["exists"]
    assert cli.main(call) == 1
    printed = capsys.readouterr().out
    assert "alone it differs" in printed and all(finding["text"] in printed for finding in report["findings"])


# Blender Asset Tracer 1 reads .blend files by itself; 2 asks the Blender that it runs in, 5.1 or later, and needs
# Python 3.13. Either prints [absolute paths of the file and of all that it needs, path of the packed file].
_TRACER = """
import importlib.metadata, json, os, sys
from pathlib import Path
import bpy

def by_1(blend, target):
    from blender_asset_tracer import pack, trace
    found = [str(use.abspath) for use in trace.deps(blend)]
    if target:
        with pack.Packer(blend, blend.parent, target) as packer:
            packer.strategise()
            packer.execute()
            assert not packer.missing_files, packer.missing_files
            return found, str(packer.output_path)
    return found, None

def by_2(blend, target):
    from blender_asset_tracer import file_usage, pack

    class Strict(pack.BATPackReporter):
        def fail(self, *problem):
            raise AssertionError(problem)

        on_missing_file = on_copy_error = on_rewrite_error = on_error_on_error = fail

    bpy.ops.wm.open_mainfile(filepath=str(blend))
    if not target:
        return [str(path) for path in file_usage.dependencies_of_current_blendfile(blend.parent).file_infoes], None
    packer = pack.BATPacker(blend.parent, file_usage.Options(), Strict(), pack_target_dir=Path(target))
    packer.start()
    while packer.step():
        pass
    return [str(path) for path in packer.deps_repo.file_infoes], str(packer.blendfile_location_abspath())

by = by_1 if importlib.metadata.version("blender-asset-tracer").startswith("1.") else by_2
found, packed = by(Path(sys.argv[1]), sys.argv[2])
print("RESULT", json.dumps([sorted({sys.argv[1], *found}), packed]))
sys.stdout.flush()
os._exit(0)
"""


def traced(blend, target=""):
    """Names of the files that BAT finds a .blend to need, itself among them, and the path of the packed one if any."""
    printed = run(_TRACER, blend, target)
    files, packed = json.loads(next(x for x in printed.splitlines() if x.startswith("RESULT")).removeprefix("RESULT"))
    return {Path(file).name for file in files}, packed


@pytest.mark.blender
@pytest.mark.versions
def test_an_asset_tracer_finds_nothing_missing(folder, original, tmp_path):
    """The scene needs itself only; a compressed file that links it, that too. Packed, both render the same bits."""
    alone, scene = traced(folder / LIBRARY, tmp_path / "alone")
    assert alone == {LIBRARY.name}
    linked, user = traced(folder / "linked.blend", tmp_path / "linked")
    assert linked == {"linked.blend", LIBRARY.name}
    packed = [path for path in tmp_path.rglob("*") if path.is_file() and path.suffix != ".txt"]
    assert sorted(path.name for path in packed) == sorted(["linked.blend", LIBRARY.name, LIBRARY.name])
    chosen = [scene, user]
    if importlib.metadata.version("blender-asset-tracer").startswith("1."):
        # Out of the project's folder: the path in the file is rewritten, for which BAT 2 needs a Blender to start.
        _, moved = traced(folder / USERS[-1], tmp_path / "moved")
        chosen.append(moved)
    for picture in pictures(tmp_path, chosen):
        assert picture.tobytes() == original.in_place.tobytes(), portable.difference(original.in_place, picture)


@pytest.mark.blender
@pytest.mark.versions
def test_an_asset_tracer_does_not_see_tables_in_files(folder):
    """What Blender knows of, it sees, also a script; but not the tables, which only `plausible portable` names."""
    found, _ = traced(folder / "needy.blend")
    # BAT 1 does not look into Script nodes either.
    assert {"needy.blend", LIBRARY.name, "wood.png"} <= found <= {"needy.blend", LIBRARY.name, "wood.png", "metal.osl"}


# The verdict, without Blender.

PICTURE = np.linspace(0.0, 1.0, 32 * 96 * 4, dtype=np.float32).reshape(32, 96, 4)


def told(monkeypatch, capsys, tmp_path, *journeys):
    """Exit code, printed text and JSON of the command where Blenders, one each, made these journeys."""
    path = tmp_path / "scene.blend"
    path.touch()
    by_name = {str(i): journey for i, journey in enumerate(journeys)}
    monkeypatch.setattr(portable, "travel", lambda blend, blender, *others: by_name[blender])
    call = ["portable", str(path), "--blender", *by_name]
    code = cli.main(call)
    text = capsys.readouterr().out
    assert cli.main([*call, "--json"]) == code
    return code, text, json.loads(capsys.readouterr().out)


def journey(alone=PICTURE, **others):
    return portable.Probe("blender", **{"version": "9.0", "in_place": PICTURE, "alone": alone, **others})


def test_one_bit_is_a_difference(monkeypatch, capsys, tmp_path):
    other = PICTURE.copy()
    other[3, 5, 1] = np.nextafter(other[3, 5, 1], np.float32(2.0))
    code, text, report = told(monkeypatch, capsys, tmp_path, journey(other))
    assert code == 1 and "1 pixels differ" in text and not report["portable"]
    assert 0.0 < report["journeys"][0]["difference"]["largest"] < 1e-6
    code, text, report = told(monkeypatch, capsys, tmp_path, journey())
    assert code == 0 and "identically" in text and "nothing would be missing" in text and report["portable"]


def test_another_version_may_differ_by_noise_and_no_more(monkeypatch, capsys, tmp_path):
    noise = np.random.default_rng(1).normal(1.0, 0.1, PICTURE.shape).astype(np.float32)
    noisy, black = PICTURE * noise, np.zeros_like(PICTURE)
    code, text, report = told(monkeypatch, capsys, tmp_path, journey(), journey(noisy, in_place=noisy))
    assert code == 0 and "another picture" not in text
    apart = report["journeys"][1]["difference_from_first"]
    # The mean of |x| of a normal x is 0.8 of its deviation, and 64 of them add up to 8 times one.
    assert 0.07 < apart["mean"] < 0.09 and 0.007 < apart["coarse"] < 0.014 and abs(apart["light"] - 1.0) < 0.01
    code, text, report = told(monkeypatch, capsys, tmp_path, journey(), journey(black, in_place=black))
    assert code == 1 and "another picture" in text and report["journeys"][1]["identical"]
    code, text, _ = told(monkeypatch, capsys, tmp_path, journey(), journey(None, error="alone: did not run"))
    assert code == 1 and "alone: did not run" in text
    code, text, _ = told(monkeypatch, capsys, tmp_path, journey(written=["metal.oso"]))
    assert code == 1 and "metal.oso" in text


def test_the_extension_is_hidden_from_a_file_that_is_alone():
    from addon.portability.probe import _Hidden

    for name in ("addon", "addon.brdf", "bl_ext.user_default.plausible_brdf"):
        with pytest.raises(ModuleNotFoundError):
            _Hidden().find_spec(name)
    assert _Hidden().find_spec("bpy") is None and _Hidden().find_spec("addon_utils") is None


def test_an_empty_script_is_named():
    script = {"external": False, "empty": True, "users": ["material 'Empty'"], "texts": []}
    (finding,) = portable._scripts([script])
    assert finding.grave and finding.subject == "material 'Empty'" and "no bytecode" in finding.text


def test_a_blender_and_a_python_are_called_each_in_its_way(tmp_path):
    blender = tmp_path / "blender"
    blender.write_text("#!/bin/sh\necho Blender 9.0\n")
    blender.chmod(0o755)
    assert portable._command(sys.executable, "script", "job", True) == [sys.executable, "script", "job"]
    there, alone = (portable._command(str(blender), "script", "job", alone)[1:] for alone in (False, True))
    assert there == ["--background", "--python", "script", "--", "job"]
    assert alone == ["--background", "--factory-startup", "--python", "script", "--", "job"]


def test_alone_means_an_environment_without_the_user(monkeypatch):
    monkeypatch.setenv("OCIO", "/studio/aces.ocio")
    monkeypatch.setenv("PYTHONPATH", "/work")
    monkeypatch.setenv("BLENDER_USER_SCRIPTS", "/home/artist/scripts")
    there, alone = portable._environment(False, "profile"), portable._environment(True, "profile")
    assert there["OCIO"] == "/studio/aces.ocio" and there["BLENDER_USER_SCRIPTS"] == "/home/artist/scripts"
    assert not {"OCIO", "PYTHONPATH", "BLENDER_USER_SCRIPTS"} & set(alone)
    assert alone["BLENDER_USER_RESOURCES"] == "profile"


@pytest.mark.parametrize(("arguments", "said"), [
    (["gone.blend"], "no file gone.blend"), (["{here}", "--blender", "no-such-blender"], "no-such-blender"),
    (["{here}", "--blender", sys.executable, "--size", "0"], "size 0"),
    (["{here}", "--blender", sys.executable, "--samples", "0"], "samples 0"),
])
def test_a_wrong_call_is_one_line(arguments, said, capsys):
    assert cli.main(["portable", *(word.format(here=__file__) for word in arguments)]) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.count("\n") == 1 and said in printed.err
