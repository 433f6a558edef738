"""The extension as a user gets it: its zip, installing and removing it, rendering with it, and rendering without it."""
import json
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from blender_help.process import run_blender

pytestmark = [pytest.mark.blender, pytest.mark.versions]

from addon import brdf, cli
from addon.backends.osl import assembler
from addon.dev.packaging import archive, checks
from addon.forms.albedo import tables


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """The extension's zip, made by the command."""
    folder = tmp_path_factory.mktemp("dist")
    assert cli.main(["build", "--output", str(folder)]) == 0
    (path,) = folder.iterdir()
    return path


def test_zip_is_what_blenders_own_builder_makes(package, tmp_path):
    command = [sys.executable, str(checks.validator()), "build", "--source-dir", str(archive.ROOT),
               "--output-dir", str(tmp_path)]
    subprocess.run(command, check=True, capture_output=True)
    with zipfile.ZipFile(package) as ours, zipfile.ZipFile(tmp_path / package.name) as official:
        assert sorted(ours.namelist()) == sorted(official.namelist())
        assert all(ours.read(name) == official.read(name) for name in ours.namelist())


def test_zip_holds_the_extension_and_nothing_else(package):
    with zipfile.ZipFile(package) as zipped:
        names = zipped.namelist()
    allowed = {"__init__.py", "blender_manifest.toml", "LICENSE", "README.md", "addon", "osl", "luts", "docs"}
    assert {name.partition("/")[0] for name in names} <= allowed
    assert not [name for name in names if "__pycache__" in name or "/." in name or name.endswith((".pyc", ".oso"))]
    manual = settings_manual()
    assert manual in names, "what Documentation in the preferences opens"
    assert {f"luts/{name}.exr" for name in tables.TABLES} <= set(names)
    assert {f"osl/{assembler.shader_path(model).name}" for model in brdf.MODELS.values()} <= set(names)


def settings_manual():
    from addon.blender.host import settings

    return settings.MANUAL.relative_to(archive.ROOT).as_posix()


def test_zip_is_the_same_bytes_for_the_same_files(package, tmp_path):
    assert archive.build(tmp_path).read_bytes() == package.read_bytes()


def test_build_reports(tmp_path, capsys):
    assert cli.main(["build", "--output", str(tmp_path), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    path = Path(report["path"])
    assert path.parent == tmp_path and path.stat().st_size == report["bytes"]
    assert report["validated"] and report["shaders_compiled"] == len(brdf.MODELS)
    assert report["files"] == len(zipfile.ZipFile(path).namelist())


def test_build_refuses_missing_tables(tmp_path, capsys):
    tables.use_folder(tmp_path / "none")
    try:
        assert cli.main(["build", "--output", str(tmp_path / "dist")]) == 2
    finally:
        tables.use_folder()
    error = capsys.readouterr().err
    assert "phong_plain.exr" in error and len(error.splitlines()) == 1
    assert not (tmp_path / "dist").exists()


def test_build_works_without_bpy(tmp_path):
    script = "import sys; sys.modules['bpy'] = None; from addon import cli; sys.exit(cli.main(sys.argv[1:]))"
    result = subprocess.run([sys.executable, "-c", script, "build", "--output", str(tmp_path)], cwd=archive.ROOT,
                            capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert "bpy is not installed" in result.stdout and list(tmp_path.glob("*.zip"))


def test_validator_rejects_a_broken_zip(tmp_path):
    broken = tmp_path / "broken.zip"
    with zipfile.ZipFile(broken, "w") as zipped:
        zipped.writestr("blender_manifest.toml", 'schema_version = "1.0.0"\nid = "plausible_brdf"\n')
    with pytest.raises(archive.PackageError, match="rejects"):
        checks.validate(broken)


@pytest.mark.parametrize("pattern", ["/a/b", "a/**", "/", "!"])
def test_patterns_that_are_not_understood_are_refused(pattern):
    with pytest.raises(archive.PackageError, match="not understood"):
        archive.is_excluded("a", False, [pattern])


CYCLES = """
import addon_utils

def state():
    keyconfigs = bpy.context.window_manager.keyconfigs
    handlers = {name: [f.__module__ for f in getattr(bpy.app.handlers, name)] for name in dir(bpy.app.handlers)
                if isinstance(getattr(bpy.app.handlers, name), list)}
    return {
        "types": sorted(dir(bpy.types)),
        "properties": {name: sorted(getattr(bpy.types, name).bl_rna.properties.keys())
                       for name in ("Material", "Scene", "Object", "WindowManager", "Node", "World")},
        "operators": dir(bpy.ops.plausible), "handlers": handlers,
        "keymaps": [(k.name, m.name, len(m.keymap_items)) for k in keyconfigs for m in k.keymaps],
        "menus": {name: len(getattr(getattr(bpy.types, name).draw, "_draw_funcs", ())) for name in dir(bpy.types)
                  if "_MT_" in name and name != "NODE_MT_add"},  # Blender itself wraps that one at the first add-on
        "addons": sorted(bpy.context.preferences.addons.keys()),
    }

addon = install(sys.argv[1])
package = addon.__package__.rpartition(".")[0]
assert "create_material" in dir(sys.modules[addon.__package__ + ".blender.material.materials"])
assert "new_material" in dir(bpy.ops.plausible) and hasattr(bpy.types.Material, "plausible_brdf")
addon_utils.disable(package, default_set=True)
before = state()
assert not before["operators"] and "plausible_brdf" not in before["properties"]["Material"]
for cycle in range(3):
    assert addon_utils.enable(package, default_set=True), f"cycle {cycle}"
    assert "bake_luts" in dir(bpy.ops.plausible)
    addon_utils.disable(package, default_set=True)
    after = state()
    assert after == before, {key: (before[key], after[key]) for key in before if before[key] != after[key]}
"""


def test_enabling_three_times_leaves_nothing_behind(package, tmp_path):
    run_blender(tmp_path, CYCLES, package)


SCENE = """
import math
bpy.ops.wm.read_factory_settings(use_empty=True)
addon = install(sys.argv[1])
scene = bpy.context.scene
bpy.ops.mesh.primitive_plane_add(size=2000.0)
scene.render.engine = "CYCLES"
assert not scene.cycles.shading_system
assert bpy.ops.plausible.new_material(model="pumped_phong") == {"FINISHED"}
assert scene.cycles.shading_system
material = bpy.context.object.active_material
material.plausible_brdf.exponent, material.plausible_brdf.pumps = 20.0, 2.0
assert addon.create_material("blinn", exponent=5.0).plausible_brdf.exponent == 5.0

# A camera without perspective shows the plane at one angle in every pixel; the world is a white furnace.
angle = math.radians(60.0)
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.data.type, camera.data.ortho_scale = "ORTHO", 1.0
camera.location = (5.0 * math.sin(angle), 0.0, 5.0 * math.cos(angle))
camera.rotation_euler = (0.0, angle, 0.0)
scene.collection.objects.link(camera)
scene.camera = camera
scene.world = bpy.data.worlds.new("furnace")
if scene.world.node_tree is None:
    scene.world.use_nodes = True
tree = scene.world.node_tree
tree.nodes.clear()
background, output = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeOutputWorld")
background.inputs[0].default_value = (1.0, 1.0, 1.0, 1.0)
tree.links.new(background.outputs[0], output.inputs[0])
scene.render.resolution_x = scene.render.resolution_y = 24
scene.cycles.samples, scene.cycles.max_bounces, scene.cycles.seed = 128, 1, 1
scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
scene.view_settings.view_transform = "Raw"
os.makedirs("made", exist_ok=True)
os.makedirs("moved", exist_ok=True)
bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath("made/scene.blend"))
print(json.dumps({"pixels": render(os.path.abspath("first.exr"))}))
"""

REOPENED = """
assert not any("plausible" in name for name in bpy.context.preferences.addons.keys())
bpy.ops.wm.open_mainfile(filepath=os.path.abspath("moved/scene.blend"))
pixels = render(os.path.abspath("second.exr"))
ours = [name for name in sys.modules if name.startswith("addon.") or name.endswith(".plausible_brdf")]
assert not ours, "the extension must not be needed"
print(json.dumps({"pixels": pixels}))
"""


def test_material_renders_its_albedo_and_needs_no_extension_afterwards(package, tmp_path):
    pixels = run_blender(tmp_path, SCENE, package)["pixels"]
    red = pixels[0::4]
    mean = sum(red) / len(red)
    noise = (sum((value - mean) ** 2 for value in red) / len(red) / (len(red) - 1)) ** 0.5
    (albedo,) = brdf.MODELS["pumped_phong"].albedo([0.5], exponent=20.0, pumps=2.0)
    assert abs(mean - albedo) < 5.0 * noise + 1e-3, f"{mean} for {albedo}, standard error {noise}"
    assert noise < 2e-3

    (tmp_path / "made/scene.blend").rename(tmp_path / "moved/scene.blend")
    again = run_blender(tmp_path, REOPENED, profile="empty")["pixels"]
    assert again == pixels


OWN_TABLES = """
addon = install(sys.argv[1])
from bl_ext.user_default.plausible_brdf.addon.blender.host import settings, table_folder, table_job
from bl_ext.user_default.plausible_brdf.addon.forms.albedo import tables
packaged = tables.folder()
table_folder.use_bake_folder()
mine = settings.granted_folder("luts")
assert tables.folder() == mine != packaged and os.environ["BLENDER_USER_RESOURCES"] in str(mine)
assert table_folder.problem(tables.TABLES) is None, "until it is baked anew, every table is a copy"
addon.unregister()
assert tables.folder() == packaged
addon.register()
assert tables.folder() == mine and table_folder.folder_problem is None, "the user's own tables are found again"
addon.unregister()
(mine / "blinn_plain.exr").write_bytes(b"half a table")
addon.register()
assert tables.folder() == packaged, "a damaged set of tables is not used"
assert "blinn_plain.exr" in table_folder.folder_problem and "The shipped tables are used" in table_folder.folder_problem
table_folder.use_bake_folder()
assert tables.folder() == mine and table_folder.problem(tables.TABLES) is None, "a bake mends the set"
assert bpy.ops.plausible.shipped_luts() == {"FINISHED"}
assert tables.folder() == packaged and not list(mine.iterdir()) and table_folder.own_tables() is None
addon.unregister()
"""


def test_baked_tables_go_to_the_users_folder(package, tmp_path):
    run_blender(tmp_path, OWN_TABLES, package)


CHOSEN = """
import pathlib, shutil
addon = install(sys.argv[1])
from bl_ext.user_default.plausible_brdf.addon.blender.host import table_folder
from bl_ext.user_default.plausible_brdf.addon.forms.albedo import tables
preferences = bpy.context.preferences.addons["bl_ext.user_default.plausible_brdf"].preferences
packaged, here = tables.folder(), pathlib.Path("mine").absolute()
preferences.lut_folder = str(here)
assert tables.folder() == packaged
assert "no such folder" in table_folder.folder_problem and str(here) in table_folder.folder_problem
try:
    bpy.ops.plausible.bake_luts(models={"pumped_phong"})
except RuntimeError as error:
    assert "no such folder" in str(error), error
here.mkdir()
shutil.copy(packaged / "phong_plain.exr", here)
preferences.lut_folder = str(here)
assert tables.folder() == packaged and "lacks phong_controlled.exr, blinn_plain.exr" in table_folder.folder_problem
assert bpy.ops.plausible.bake_luts(models={"edwards_fit"}, resolution="draft", highest=2.0) == {"FINISHED"}
assert tables.folder() == here and table_folder.folder_problem is None, "a bake fills the folder"
assert tables.in_use("disk_volume").span == (0.0, 2.0)
preferences.lut_folder = ""
assert tables.folder() == packaged and table_folder.folder_problem is None
assert tables.in_use("disk_volume").span == (0.0, 1e5)

# What new materials begin with; Python's own do not ask.
preferences.samples, preferences.light_spread = 7, 0.5
bpy.ops.mesh.primitive_plane_add()
assert bpy.ops.plausible.new_material(model="phong") == {"FINISHED"}
made = bpy.context.object.active_material.plausible_brdf
assert (made.samples, made.light_spread) == (7, 0.5)
made = addon.create_material("phong").plausible_brdf
assert (made.samples, made.light_spread) == (4, 1.0)
addon.unregister()
"""


def test_preferences_take_effect_at_once(package, tmp_path):
    run_blender(tmp_path, CHOSEN, package)


# A stand-in for weights, which take seconds to bake.
CACHE = """
if not os.path.isdir(os.path.join(os.environ["BLENDER_USER_RESOURCES"], "extensions/user_default/plausible_brdf")):
    install(sys.argv[1])
else:
    import addon_utils
    assert addon_utils.enable("bl_ext.user_default.plausible_brdf", default_set=True)
addon = sys.modules["bl_ext.user_default.plausible_brdf.addon"]
from bl_ext.user_default.plausible_brdf.addon.forms.rows import error as rows_error
from bl_ext.user_default.plausible_brdf.addon.forms.rows import row_bake
from bl_ext.user_default.plausible_brdf.addon.blender.host import row_cache, settings
from bl_ext.user_default.plausible_brdf.addon.blender.material import baked_state, groups
from bl_ext.user_default.plausible_brdf.addon.blender.backend import osl
import numpy as np
calls, blank = [], row_bake.blank
row_bake.bake = lambda model, p: calls.append("weights") or blank(model, p)
known = rows_error.RowsError(np.zeros(1), np.array([0.0125]), np.array([-0.001]))
rows_error.error = lambda model, p: calls.append("error") or known
material = addon.create_material("ward", roughness_u=0.25)
folder = settings.granted_folder("cache")
assert len(list(folder.iterdir())) == 2 and row_cache.size() > 100
assert baked_state.baked_error(groups.find_node(material)) == (0.0125, 0.001)
text = osl.script_of(groups.find_node(material)).bytecode
preferences = bpy.context.preferences.addons["bl_ext.user_default.plausible_brdf"].preferences
found = {"calls": calls[:], "bytes": len(text)}
if len(sys.argv) > 2:
    for path in folder.iterdir():
        path.write_bytes(path.read_bytes()[:-3])
    row_cache._memory.clear()
    addon.create_material("ward", roughness_u=0.25)
    assert len(calls) == len(found["calls"]) + 2, "what is damaged is baked anew"
    assert bpy.ops.plausible.clear_cache() == {"FINISHED"} and row_cache.size() == 0 and not list(folder.iterdir())
    addon.create_material("ward", roughness_u=0.25)
    assert row_cache.size() > 0
    preferences.cache_limit = 0
    assert row_cache.size() == 0, "no limit, no cache"
    addon.create_material("ward", roughness_u=0.25)
    assert row_cache.size() == 0
addon.unregister()
print(json.dumps(found))
"""


def test_what_is_baked_is_kept_for_the_next_session(package, tmp_path):
    first = run_blender(tmp_path, CACHE, package)
    assert first["calls"] == ["weights", "error"]
    assert run_blender(tmp_path, CACHE, package, "spoil") == {"calls": [], "bytes": first["bytes"]}


SESSION = """
import pathlib, tempfile
profile = pathlib.Path(os.environ["BLENDER_USER_RESOURCES"])
assert pathlib.Path.cwd() in pathlib.Path(tempfile.gettempdir()).parents
addon = install(sys.argv[1])
own = profile / "extensions/.user/user_default/plausible_brdf"

def listing():
    found = {}
    for path in pathlib.Path.cwd().rglob("*"):
        if own not in (path, *path.parents) and "__pycache__" not in path.parts:
            found[str(path)] = path.read_bytes() if path.is_file() else None
    return found

before = listing()
assert not own.exists(), "nothing is made before it is needed"
from bl_ext.user_default.plausible_brdf.addon.forms.rows import error as rows_error
from bl_ext.user_default.plausible_brdf.addon.forms.rows import row_bake
import numpy as np
blank, known = row_bake.blank, rows_error.RowsError(np.zeros(1), np.array([0.01]), np.array([0.0]))
row_bake.bake, rows_error.error = lambda model, p: blank(model, p), lambda model, p: known
addon.create_material("ward")
addon.create_material("pumped_phong")
assert bpy.ops.plausible.bake_luts(models={"edwards_fit"}, resolution="draft", highest=2.0) == {"FINISHED"}
after = listing()
changed = {path for path in before.keys() | after.keys() if before.get(path) != after.get(path)}
assert changed <= {str(own.parent.parent), str(own.parent)}, changed  # Blender's, for all extensions
assert {path.name for path in own.iterdir()} == {"cache", "luts"}

repos = bpy.context.preferences.extensions.repos
index = next(i for i, repo in enumerate(repos) if repo.module == "user_default")
assert bpy.ops.extensions.package_uninstall(repo_index=index, pkg_id="plausible_brdf") == {"FINISHED"}
left = [str(path) for path in profile.rglob("*") if "plausible" in path.name]
assert not left, left
assert not any("plausible" in name for name in bpy.context.preferences.addons.keys())
assert not [name for name in dir(bpy.types) if "plausible" in name.lower()]
assert not hasattr(bpy.types.Material, "plausible_brdf") and not dir(bpy.ops.plausible)
"""


def test_a_session_writes_to_its_own_folder_and_uninstalling_removes_it(package, tmp_path):
    """Compared are the profile, the folders for temporary files and for the user's, and the one that it runs in."""
    temporary, home = tmp_path / "tmp", tmp_path / "home"
    temporary.mkdir()
    home.mkdir()
    run_blender(tmp_path, SESSION, package, TMPDIR=str(temporary), HOME=str(home), XDG_CONFIG_HOME=str(home))


ENABLE = """
import addon_utils
assert bpy.ops.extensions.package_install_files(
    filepath=sys.argv[1], repo="user_default", enable_on_install=False) == {"FINISHED"}
before = set(sys.modules)
assert addon_utils.enable("bl_ext.user_default.plausible_brdf", default_set=True)
loaded = sorted(set(sys.modules) - before)
sys.modules["bl_ext.user_default.plausible_brdf"].unregister()
print(json.dumps({"loaded": loaded}))
"""


def test_enabling_loads_nothing_that_is_slow_and_the_zip_is_small(package, tmp_path):
    loaded = run_blender(tmp_path, ENABLE, package)["loaded"]
    assert any(name.endswith("addon.blender.ui.panels") for name in loaded)
    assert not {"scipy", "matplotlib", "colour", "OpenImageIO"} & set(loaded)
    assert not [name for name in loaded if ".addon.measure" in name or ".addon.dev.demo" in name or ".figures" in name]
    assert 1e6 < package.stat().st_size < 10e6


FAILING = """
addon = install(sys.argv[1])
addon.unregister()
before = sorted(dir(bpy.types))
from bl_ext.user_default.plausible_brdf.addon.blender.ui import preferences
class Broken(bpy.types.Operator):
    bl_idname = "this is no name"
    bl_label = "Broken"
preferences.CLASSES = (*preferences.CLASSES, Broken)
try:
    addon.register()
except (RuntimeError, ValueError) as error:
    assert "this is no name" in str(error), error
else:
    raise AssertionError("a failure to register was swallowed")
assert sorted(dir(bpy.types)) == before and not hasattr(bpy.types.Material, "plausible_brdf")
"""


def test_failing_registration_is_raised_and_taken_back(package, tmp_path):
    run_blender(tmp_path, FAILING, package)
