"""Faults of files, disks and users: each ends in a sentence, whole files, and a material that can be mended."""
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from blender_help.materials import make
from blender_help.process import run_blender
from blender_help.recorder import Recorder, context_for, drawn, operators, texts

pytestmark = [pytest.mark.blender, pytest.mark.versions]

from addon.brdf import MODELS
from addon.forms.albedo import tables
from addon.forms.albedo.tables import TABLES, TableError

ROOT = Path(__file__).resolve().parents[1]


# Materials that were edited by hand


def node_in(material):
    return next(node for node in material.node_tree.nodes if node.bl_idname == "ShaderNodeGroup")


def script_in(material):
    return next(node for node in node_in(material).node_tree.nodes if node.bl_idname == "ShaderNodeScript")


def socket_item(material, name):
    items = node_in(material).node_tree.interface.items_tree
    return next(item for item in items if item.item_type == "SOCKET" and item.name == name)


def without_socket(name):
    return lambda material: node_in(material).node_tree.interface.remove(socket_item(material, name))


def with_type(name, kind):
    def edit(material):
        socket_item(material, name).socket_type = kind

    return edit


def with_property(key, value):
    def edit(material):
        node_in(material).node_tree[key] = value

    return edit


def with_node_property(key, value):
    def edit(material):
        node_in(material)[key] = value

    return edit


def without_property(key):
    def edit(material):
        del node_in(material).node_tree[key]

    return edit


def without_script(material):
    node_in(material).node_tree.nodes.remove(script_in(material))


def without_stand_in(material):
    nodes = node_in(material).node_tree.nodes
    for node in [node for node in nodes if node.name.startswith("Stand-in")]:
        nodes.remove(node)


def with_a_stand_in_of_mine(material):
    without_stand_in(material)
    node_in(material).node_tree.nodes.new("ShaderNodeBsdfDiffuse").name = "Stand-in"


def with_nodes_of_mine_inside(material):
    tree = node_in(material).node_tree
    number = tree.nodes.new("ShaderNodeMath")
    for socket in list(script_in(material).inputs)[:6]:
        tree.links.new(number.outputs[0], socket)


def with_bytecode(text):
    def edit(material):
        script_in(material).bytecode = text

    return edit


def with_two_nodes(material):
    from addon.blender.material import groups

    groups.add_node(material.node_tree, MODELS["pumped_blinn"])


def nested(material):
    """Our node is moved into a group of the user's."""
    import bpy

    outer = bpy.data.node_groups.new("Mine", "ShaderNodeTree")
    outer.nodes.new("ShaderNodeGroup").node_tree = node_in(material).node_tree
    node_in(material).node_tree = outer


def without_sockets(material):
    node_in(material).node_tree.interface.clear()


def without_links(material):
    node_in(material).node_tree.links.clear()


def without_group(material):
    node_in(material).node_tree = None


EDITS = {
    "no exponent": without_socket("Exponent"), "no normal": without_socket("Normal"),
    "no sockets": without_sockets, "no links inside": without_links, "no BSDF": without_socket("BSDF"),
    "no stand-in output": without_socket("Stand-in"), "exponent is a colour": with_type("Exponent", "NodeSocketColor"),
    "exponent is a shader": with_type("Exponent", "NodeSocketShader"),
    "BSDF is a colour": with_type("BSDF", "NodeSocketColor"), "no script": without_script,
    "no stand-in": without_stand_in, "another stand-in": with_a_stand_in_of_mine,
    "nodes inside": with_nodes_of_mine_inside, "no bytecode": with_bytecode(""), "garbage": with_bytecode("garbage"),
    "no group": without_group, "nested": nested, "two nodes": with_two_nodes,
    "unknown model": with_property("plausible_model", "gone"), "model is a number": with_property("plausible_model", 3),
    "model is a list": with_property("plausible_model", [1.0, 2.0]), "no model": without_property("plausible_model"),
    "another model": with_property("plausible_model", "edwards_empirical"),
    "another, baked model": with_property("plausible_model", "ward"),
    "baked is an object": with_property("plausible_baked", "{}"),
    "baked is a number": with_property("plausible_baked", 3),
    "baked is half": with_property("plausible_baked", '[{"exponent": 1.0}'),
    "baked files are a list": with_property("plausible_baked", '[{}, [1]]'),
    "error is a text": with_property("plausible_baked_error", "little"),
    "error is a number": with_property("plausible_baked_error", 0.1),
    "no spans": without_property("plausible_spans"), "spans are a text": with_property("plausible_spans", "all"),
    "spans hold texts": with_property("plausible_spans", {"phong_plain": "x", "phong_controlled": [1.0]}),
    "version is a number": with_property("plausible_version", 2), "no version": without_property("plausible_version"),
    "lut is a list": with_property("plausible_lut", [1]), "lut is unknown": with_property("plausible_lut", "tape"),
    "pumps are a text": with_node_property("plausible_pumps", "many"),
    "pumps beyond": with_node_property("plausible_pumps", 1e9),
    "sockets are a number": with_property("plausible_sockets", 1), "no map": without_property("plausible_sockets"),
    "sockets are half": with_property("plausible_sockets", '{"exponent"'),
    "sockets are a list": with_property("plausible_sockets", '["exponent"]'),
    "backend is unknown": with_property("plausible_backend", "tape"),
    "backend is a number": with_property("plausible_backend", 3), "no backend": without_property("plausible_backend"),
}


def operate(bpy, material, name, **settings):
    """Run an operator where it may; returns what it reports where it cannot do it."""
    with bpy.context.temp_override(material=material):
        operator = getattr(bpy.ops.plausible, name)
        if not operator.poll():
            return ""
        try:
            operator(**settings)
        except RuntimeError as error:
            assert "Python:" not in str(error) and "Traceback" not in str(error), f"{name}: {error}"
            return str(error)
    return ""


def draw_all(bpy, material):
    """Draw every panel and plot what is asked for, with few nodes; returns what is drawn."""
    from addon.blender.ui import energy, furnace_test

    context, log = context_for(bpy, material), drawn(context_for(bpy, material))
    for cls in (*energy.CLASSES, *furnace_test.CLASSES):
        if getattr(cls, "bl_space_type", "") == "PROPERTIES" and cls.poll(context):
            face = type(cls.__name__, cls.__bases__[:-1], {})()
            face.layout = Recorder(log)
            cls.draw(face, context)
    energy.make_wanted()
    return log


def use_all(bpy, material):
    """Everything that a user or Blender does to a material, one after the other; what is reported."""
    from addon.blender.material import upgrade, watch
    from addon.measure import specimen

    group = material.plausible_brdf
    for name in [prop.identifier for prop in group.bl_rna.properties]:
        getattr(group, name)
    watch._changed.add(material.name_full)
    watch._look()
    specimen._formula(material)
    said = [upgrade.upgrade_all()]
    for name, settings in (
            ("switch_width", {}), ("compare_pumping", {}), ("compare_pumping", {}), ("switch_native", {}),
            ("switch_native", {}), ("set_metal", {"metal": "gold"}), ("bake_weights", {}), ("update_materials", {}),
            ("upgrade", {}), ("convert", {"model": "blinn"}), ("apply_preset", {"preset": "gold_satin"})):
        said.append(operate(bpy, material, name, **settings))
    return [words for words in said if words]


@pytest.mark.parametrize(("model_id", "edit"), [
    *(("pumped_phong", edit) for edit in EDITS if not edit.startswith(("baked ", "error "))),
    *(("ward", edit) for edit in EDITS if edit.startswith(("baked ", "error ", "no s", "no b", "another"))),
])
def test_a_material_that_was_edited_raises_nothing(bpy, no_weights, capfd, model_id, edit):
    from addon.blender.material import groups, sockets

    material = make(model_id)
    EDITS[edit](material)
    draw_all(bpy, material)
    use_all(bpy, material)
    fresh = groups.find_node(make(model_id))
    assert len(sockets.by_id(fresh)) >= len(MODELS[model_id].parameters), "another material gets a whole group"
    assert not groups.lacking(fresh.node_tree)
    printed = "".join(capfd.readouterr())
    assert "Traceback" not in printed and "Python script error" not in printed, printed


TOLD = {
    "no script": "its shader is gone or damaged", "no bytecode": "its shader is gone or damaged",
    "garbage": "its shader is gone or damaged", "exponent is a colour": "lacks Exponent",
    "nodes inside": "lacks", "no BSDF": "lacks BSDF", "no stand-in": "lacks Stand-in",
    "no links inside": "lacks Exponent, Use Roughness, Roughness, Pumps", "another model": "lacks Diffuse Color",
}


@pytest.mark.parametrize("edit", TOLD)
def test_what_a_node_lacks_is_told_and_a_fresh_one_takes_its_place(bpy, edit):
    from addon.blender.material import groups, repair, sockets

    material = make("pumped_phong", exponent=33.0, base_color=(0.5, 0.25, 0.125), samples=7)
    tree = material.node_tree
    colour = tree.nodes.new("ShaderNodeRGB")
    tree.links.new(colour.outputs[0], sockets.by_id(node_in(material))["base_color"])
    assert "plausible.renew" not in operators(drawn(context_for(bpy, material)))
    EDITS[edit](material)
    log = drawn(context_for(bpy, material))
    assert TOLD[edit] in texts(log) and "plausible.renew" in operators(log)
    assert operate(bpy, material, "renew") == ""
    assert not repair.broken(material) and "plausible.renew" not in operators(drawn(context_for(bpy, material)))
    node = groups.find_node(material)
    if edit != "another model":
        held = sockets.by_id(node)
        assert held["samples"].default_value == 7
        assert held["base_color"].is_linked
    if edit not in ("no BSDF", "BSDF is a colour"):
        assert tree.get_output_node("CYCLES").inputs["Surface"].links[0].from_node == node


def test_a_fresh_node_keeps_its_backend(bpy):
    from addon.blender import backend
    from addon.blender.material import groups

    material = make("pumped_phong")
    assert operate(bpy, material, "switch_native") == ""
    with_type("Exponent", "NodeSocketColor")(material)
    assert operate(bpy, material, "renew") == ""
    assert groups.backend_of(groups.find_node(material)) == backend.FALLBACK, "the panel says so, and goes back"
    assert operate(bpy, material, "switch_native") == ""
    assert groups.backend_of(groups.find_node(material)) == backend.DEFAULT


def test_values_of_an_edited_node_are_written_whole_or_not_at_all(bpy):
    from addon.blender.material import groups, materials

    material = make("pumped_phong", base_color=(0.5, 0.25, 0.125))
    with_type("Extinction k", "NodeSocketFloat")(material)
    said = operate(bpy, material, "set_metal", metal="gold")
    assert "was edited and lacks Extinction k: Renew Node" in said
    assert tuple(material.plausible_brdf.base_color) == (0.5, 0.25, 0.125)
    node = groups.find_node(material)
    with pytest.raises(ValueError, match="lacks Extinction k"):
        materials.set_value(node, MODELS["pumped_phong"].parameter("extinction"), (1.0, 1.0, 1.0))


def test_a_socket_that_is_gone_is_not_written(bpy):
    """Another material that uses the group lacks it as well; a fresh node has it again."""
    from addon.blender.material import groups, materials, sockets

    first, second = make("pumped_phong"), make("pumped_phong")
    assert node_in(first).node_tree == node_in(second).node_tree
    without_socket("Pumps")(first)
    pumps = MODELS["pumped_phong"].parameter("pumps")
    with pytest.raises(ValueError, match="lacks Pumps"):
        materials.set_value(groups.find_node(first), pumps, 3.0)
    assert operate(bpy, first, "renew") == ""
    materials.set_value(groups.find_node(first), pumps, 3.0)
    assert sockets.get_value(groups.find_node(first), pumps) == 3.0
    assert sockets.get_value(groups.find_node(second), pumps) == pumps.default


@pytest.mark.parametrize("edit", ["no bytecode", "garbage", "no exponent", "no links inside", "no script"])
def test_an_edited_material_is_measured_or_refused(edit, tmp_path, capfd):
    """What has no shader is refused: bytecode that is announced and empty would end Blender."""
    import bpy

    from addon import cli

    material = make("pumped_phong")
    material.name = "Edited"
    EDITS[edit](material)
    bpy.data.libraries.write(str(tmp_path / "edited.blend"), {material}, fake_user=True)
    code = cli.main(["furnace", "--blend", str(tmp_path / "edited.blend"), "--material", "Edited", "--angles", "40",
                     "--samples", "4", "--resolution", "4", "--json"])
    printed = capfd.readouterr()
    assert "Traceback" not in printed.out + printed.err
    if TOLD.get(edit) == "its shader is gone or damaged":
        assert code == 2 and "press Renew Node" in printed.err and printed.err.count("\n") == 1
    else:
        report = json.loads(printed.out[printed.out.index("{"):])
        assert code in (0, 1) and np.isfinite(report["rows"][0]["measured"]).all()
    bpy.ops.wm.read_factory_settings(use_empty=True)


def test_a_file_without_bytecode_does_not_end_blender(bpy, tmp_path):
    from addon.measure import instruments

    EDITS["no bytecode"](make("pumped_phong"))
    bpy.data.libraries.write(str(tmp_path / "edited.blend"), set(bpy.data.materials), fake_user=True)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "edited.blend"))
    (material,) = bpy.data.materials
    measured, _ = instruments.furnace(material, [40.0], 1, 4)
    assert np.all(measured == 0.0)
    assert operate(bpy, material, "renew") == ""
    assert instruments.furnace(material, [40.0], 16, 4)[0].min() > 0.7
    bpy.ops.wm.read_factory_settings(use_empty=True)


# Tables of another kind

def written_by_openimageio(path, pixels, kind="float", channels=4, compression="none"):
    oiio = pytest.importorskip("OpenImageIO")
    height, width = pixels.shape[:2]
    spec = oiio.ImageSpec(width, height, channels, kind)
    if path.suffix == ".exr":
        spec.attribute("compression", compression)
    file = oiio.ImageOutput.create(str(path))
    assert file.open(str(path), spec), file.geterror()
    assert file.write_image(np.ascontiguousarray(pixels[..., :channels], dtype=np.float32)), file.geterror()
    file.close()


def as_png(path, pixels):
    written_by_openimageio(path.with_suffix(".png"), np.clip(pixels, 0.0, 1.0), "uint16")
    path.with_suffix(".png").replace(path)


KINDS = {
    "half": lambda path, pixels: written_by_openimageio(path, pixels, "half"),
    "three channels": lambda path, pixels: written_by_openimageio(path, pixels, channels=3),
    "one channel": lambda path, pixels: written_by_openimageio(path, pixels, channels=1),
    "PNG": as_png,
}


@pytest.mark.parametrize("kind", [*KINDS, "compressed"])
def test_a_table_of_another_kind_is_told(kind, bpy, table_folder):
    from addon.models import exr

    shutil.copytree(tables.PACKAGED, table_folder, dirs_exist_ok=True)
    path = TABLES["phong_controlled"].path
    pixels = exr.read(path)[0]
    if kind == "compressed":
        written_by_openimageio(path, pixels, compression="zip")
    else:
        KINDS[kind](path, pixels)
    before = path.read_bytes()
    tables.forget()
    with pytest.raises(TableError) as caught:
        make("pumped_phong")
    assert caught.value.path == path and caught.value.code == "image"
    material = make("phong")
    said = operate(bpy, material, "convert", model="pumped_phong")
    assert "phong_controlled.exr" in said and material.plausible_brdf.model == "phong", said
    assert path.read_bytes() == before and not bpy.data.materials.get("Pumped Phong")


# Files of the extension that are gone

@pytest.fixture
def installed(tmp_path, monkeypatch):
    """A copy of the shaders and of what is fitted, in use for the test."""
    from addon import resources

    for name in ("osl", "luts"):
        shutil.copytree(ROOT / name, tmp_path / name)
        monkeypatch.setattr(resources, name.upper(), tmp_path / name)
    return tmp_path


@pytest.mark.parametrize("lost", ["osl/lobe.osl", "osl/include/table.h", "osl/include/power.h",
                                  "luts/base_lobes.json"])
@pytest.mark.parametrize("how", ["gone", "cut"])
def test_a_lost_file_of_the_extension_is_named(lost, how, bpy, installed):
    path = installed / lost
    if how == "gone":
        path.unlink()
    else:
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    context = {"object": thing(bpy), "active_object": thing(bpy)}
    with bpy.context.temp_override(**context), pytest.raises(RuntimeError) as caught:
        bpy.ops.plausible.new_material(model="pumped_phong")
    said = str(caught.value)
    assert "Traceback" not in said
    assert ("install it again" in said and path.name in said) or (how == "cut" and "did not compile" in said), said
    assert not bpy.data.materials and not [group for group in bpy.data.node_groups if group.users]


def thing(bpy):
    found = bpy.data.objects.get("Thing") or bpy.data.objects.new("Thing", bpy.data.meshes.new("Thing"))
    if found.name not in bpy.context.scene.collection.objects:
        bpy.context.scene.collection.objects.link(found)
    return found


@pytest.mark.parametrize("spoil", [lambda path: path.unlink(), lambda path: path.write_bytes(b"\x89PNG\r\n\x1a\nhalf"),
                                   lambda path: path.write_bytes(b"")], ids=["gone", "cut", "empty"])
def test_pictures_that_cannot_be_read_are_none(spoil, bpy, monkeypatch, tmp_path):
    from addon import assets
    from addon.blender.ui import icons

    shutil.copytree(assets.preview("phong").parent, tmp_path, dirs_exist_ok=True)
    for path in tmp_path.glob("*.png"):
        spoil(path)
    monkeypatch.setattr(assets, "preview", lambda key: tmp_path / f"{key}.png")
    icons.start(in_background=True)
    try:
        assert "plausible.new_material" in operators(drawn(context_for(bpy, make("pumped_phong"))))
        assert isinstance(icons.icon_of("phong"), int)
    finally:
        icons.stop()


# Bakes that share a folder, or are killed

def bake(folder, *options):
    return subprocess.Popen([sys.executable, "-m", "addon.cli", "bake", "disk_volume", "--resolution", "draft",
                             "--range", "1", "4", "--output", str(folder), *options], cwd=ROOT, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def test_two_bakes_into_one_folder(tmp_path):
    """Both end well, and the table is one of theirs, which are alike."""
    both = [bake(tmp_path, "--workers", "1") for _ in range(2)]
    ends = [(process.wait(timeout=120), process.communicate()[1]) for process in both]
    assert [code for code, _ in ends] == [0, 0], ends
    assert [path.name for path in tmp_path.iterdir()] == ["disk_volume.exr"]
    tables.use_folder(tmp_path)
    try:
        assert tables.in_use("disk_volume").span == (0.0, 4.0)
    finally:
        tables.use_folder()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="asks /proc for processes")
def test_a_killed_bake_takes_its_workers_along(tmp_path):
    old = tmp_path / "disk_volume.exr"
    shutil.copyfile(TABLES["disk_volume"].path, old)
    process = bake(tmp_path, "--workers", "2")
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    workers = []
    while len(workers) < 2 and process.poll() is None:
        workers = children.read_text().split()
        time.sleep(0.02)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate()
    assert len(workers) == 2
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline and any(is_alive(worker) for worker in workers):
        time.sleep(0.05)
    assert not any(is_alive(worker) for worker in workers)
    assert old.read_bytes() == TABLES["disk_volume"].path.read_bytes()


def is_alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


# Manifest and preferences

@pytest.mark.parametrize(("text", "words"), [
    ("id = ", "blender_manifest.toml"), ("", "id is None"), ('id = "plausible_brdf"\nversion = 2\n', None),
    ('id = "plausible_brdf"\n', "version is None"), ('id = "../x"\nversion = "1.0.0"\n', "id is '../x'"),
    ('id = "a"\nversion = "1.0.0"\nbuild = 3\n', "build is 3"), (b"\xff\xfe", "blender_manifest.toml"),
])
def test_a_broken_manifest_is_told_by_build(text, words, tmp_path, monkeypatch, capsys):
    from addon import cli
    from addon.dev.packaging import archive, checks

    (tmp_path / "blender_manifest.toml").write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(archive.PackageError, match=words or "missing"):
        archive.files(tmp_path)
    monkeypatch.setattr(archive.build, "__defaults__", (tmp_path,))
    monkeypatch.setattr(checks, "check_shaders", lambda: 0)
    assert cli.main(["build", "--output", str(tmp_path / "dist")]) == 2
    error = capsys.readouterr().err
    assert "Traceback" not in error and not (tmp_path / "dist").exists()


MANIFEST = """
import pathlib
addon = install(sys.argv[1])
addon.unregister()
from bl_ext.user_default.plausible_brdf.addon import version
path = version._MANIFEST
whole = path.read_text()
for text, word in (("version = ", "cannot be read"), ('id = "x"', "cannot be read"), ('version = "new"', "expected"),
                   (None, "cannot be read")):
    path.write_text(text) if text is not None else path.unlink()
    try:
        version._read()
    except ImportError as error:
        assert word in str(error) and str(path) in str(error) and "install" in str(error), error
    else:
        raise AssertionError(f"{text}: nothing was said")
path.write_text(whole.replace(f'version = "{version.VERSION}"', 'version = "99.0.1"'))
assert version._read() == "99.0.1"
path.write_text(whole)
addon.register()
addon.unregister()
"""
PREFERENCES = """
import addon_utils, math
from pathlib import Path
package = "bl_ext.user_default.plausible_brdf"
if len(sys.argv) > 2:  # the preferences are no longer those that this Blender saved
    assert addon_utils.enable(package, default_set=True)
    addon = sys.modules[package + ".addon"]
else:
    addon = install(sys.argv[1])
from bl_ext.user_default.plausible_brdf.addon.blender.host import row_cache, settings
from bl_ext.user_default.plausible_brdf.addon.brdf import MODELS
made = 0
for samples, spread, limit, folder in ((99, math.nan, -3, "\\0"), ("many", [1.0], "all", 3), (-7, 1e30, 10**9, "//..")):
    chosen = settings.preferences()
    store = chosen.bl_system_properties_get(do_create=True) if hasattr(chosen, "bl_system_properties_get") else chosen
    for name, value in (("samples", samples), ("light_spread", spread), ("cache_limit", limit), ("lut_folder", folder)):
        try:
            store[name] = value
        except (TypeError, ValueError, OverflowError):
            continue  # this Blender does not take it
        made += 1
    values = settings.for_new(MODELS["phong"])
    assert 1 <= values["samples"] <= 8 and 0.0 <= values["light_spread"] <= 2.0, values
    assert settings.cache_limit() >= 0 and isinstance(settings.lut_folder(), str)
    row_cache.trim()
    addon.unregister()
    addon.register()
    bpy.ops.mesh.primitive_plane_add()
    assert bpy.ops.plausible.new_material(model="phong") == {"FINISHED"}
assert made >= 6, made
for name in ("samples", "light_spread", "cache_limit", "lut_folder"):
    settings.preferences().property_unset(name)
bpy.ops.wm.save_userpref()
addon.unregister()
"""


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    from addon.dev.packaging import archive

    return archive.build(tmp_path_factory.mktemp("dist"))


def test_a_broken_manifest_of_what_is_installed_is_told(package, tmp_path):
    run_blender(tmp_path, MANIFEST, package)


def test_preferences_that_are_damaged(package, tmp_path):
    """Values of other types and beyond their ranges; then a file of preferences that ends half-way."""
    run_blender(tmp_path, PREFERENCES, package)
    (saved,) = (tmp_path / "profile").rglob("userpref.blend")
    saved.write_bytes(saved.read_bytes()[: saved.stat().st_size // 2])
    run_blender(tmp_path, PREFERENCES, package, "again")


# Tables in files, which the shader reads

def no_numbers(path, pixels):
    rewritten(path, pixels, np.nan)


def zeros(path, pixels):
    rewritten(path, pixels, 0.0)


def rewritten(path, pixels, value):
    from addon.models import exr

    image = pixels.copy()
    image[1:-1] = value
    exr.write(path, image, {})


def a_row_less(path, pixels):
    from addon.models import exr

    exr.write(path, np.delete(pixels, 20, axis=0), {})


def half_the_columns(path, pixels):
    from addon.models import exr

    exr.write(path, np.ascontiguousarray(pixels[:, ::2]), {})


@pytest.mark.parametrize("spoil", [no_numbers, zeros, a_row_less, half_the_columns, KINDS["half"],
                                   KINDS["one channel"]])
def test_a_spoilt_file_is_told_in_picture_and_panel(spoil, bpy, tmp_path, capfd):
    from blender_help.materials import use_table
    from optics.plane import picture

    from addon.models import exr

    path = tmp_path / "spoilt.exr"
    spoil(path, exr.read(TABLES["phong_controlled"].path)[0])
    material = make("pumped_phong", lut="file")
    assert "plausible bake" not in texts(drawn(context_for(bpy, material)))
    use_table(material, True, path)
    assert "spoilt.exr" in texts(drawn(context_for(bpy, material))).replace(" ", "")
    if spoil is half_the_columns:  # markers say nothing of columns, and the shader cannot ask: the panel does
        return
    capfd.readouterr()
    pixels = picture(material, 60.0, 1)
    assert np.isfinite(pixels).all() and not pixels[:, 1].any() and pixels[:, 0].any(), "stripes"
    assert str(path) in capfd.readouterr().err
