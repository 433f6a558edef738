"""The asset library: whole, of today's shaders, listed while the extension is on, and ready to be dropped."""
import numpy as np
import pytest

from addon.assets import LIBRARY
from addon.backends.osl import estimator
from addon.brdf import MODELS
from addon.dev.packaging import assets
from addon.library.presets import PRESETS
from addon.measure import scene

pytestmark = [pytest.mark.blender, pytest.mark.versions]

SHOWN = {model.id: model for model in MODELS.values() if not estimator.is_baked(model)}


@pytest.fixture
def contents(bpy):
    """(materials by label, node groups by label) of the library, appended to an empty file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(str(LIBRARY), assets_only=True) as (there, wanted):
        wanted.materials, wanted.node_groups = there.materials, there.node_groups
    yield {m.name: m for m in wanted.materials}, {t.name: t for t in wanted.node_groups}
    bpy.ops.wm.read_factory_settings(use_empty=True)


def test_every_preset_and_model_is_there(contents):
    from addon.blender.material import baked_state, groups, sockets, upgrade
    from addon.version import VERSION

    materials, models = contents
    assert set(materials) == {preset.label for preset in PRESETS.values()}
    assert set(models) == {model.label for model in SHOWN.values()}
    for preset in PRESETS.values():
        node = groups.find_node(materials[preset.label])
        model = groups.model_of(node)
        assert model.id == preset.model and upgrade.version_of(node) == VERSION
        expected = model.resolve(preset.parameters)
        for key, value in sockets.values(node).items():
            assert value == pytest.approx(expected[key], rel=1e-6), (preset.label, key)
        assert not baked_state.is_stale(node), preset.label


def test_shaders_are_todays(contents):
    """A shader that was changed since the library was made must not ship as it was: ./run assets makes it anew."""
    from addon.blender.backend import osl
    from addon.blender.material import groups

    for model in SHOWN.values():
        (script,) = [n for n in contents[1][model.label].nodes if n.bl_idname == "ShaderNodeScript"]
        assert script.bytecode == osl.Osl().program(model).content, model.id
    assert contents[1]["Phong"].get(groups.VERSION_KEY)


def test_catalogues_name_each_asset(contents):
    lines = (LIBRARY.parent / assets.CATALOGUES).read_text(encoding="utf-8").splitlines()
    known = {line.split(":")[0]: line.split(":")[1] for line in lines if line.count(":") == 2}
    assert set(known.values()) >= {f"Plausible/{preset.group}" for preset in PRESETS.values()} | {"Plausible/Nodes"}
    for preset in PRESETS.values():
        data = contents[0][preset.label].asset_data
        assert known[data.catalog_id] == f"Plausible/{preset.group}" and data.description == preset.help
    assert {known[tree.asset_data.catalog_id] for tree in contents[1].values()} == {"Plausible/Nodes"}


def test_thumbnails_show_something(contents):
    for block in (*contents[0].values(), *contents[1].values()):
        assert block.preview is not None, block.name
        size = tuple(block.preview.image_size)
        pixels = np.array(block.preview.image_pixels_float[:]).reshape(size[1], size[0], 4)
        assert min(size) >= 96 and pixels[..., :3].std() > 0.02, block.name


def test_a_dropped_material_renders(contents):
    from addon.blender.material import groups, sockets

    material = contents[0][PRESETS["gold_satin"].label]
    node = groups.find_node(material)
    with scene.MeasuringScene(material, scene.PLANE, 8) as place:
        place.sky(1.0)
        place.look_from((np.sin(1.0), 0.0, np.cos(1.0)))
        found = place.render(64).mean(axis=(0, 1))
    expected = groups.model_of(node).albedo(np.cos([1.0]), **sockets.values(node))[0]
    np.testing.assert_allclose(found, expected, atol=0.01)


def test_it_is_in_the_preferences_while_the_extension_is_on():
    from bpy import context

    import addon

    def listed():
        return [each.path for each in context.preferences.filepaths.asset_libraries if each.name == "Plausible BRDF"]

    assert not listed()
    addon.register()
    try:
        assert [path.rstrip("/\\") for path in listed()] == [str(LIBRARY.parent)]
    finally:
        addon.unregister()
    assert not listed()


def test_what_has_no_picture_is_told(monkeypatch, tmp_path):
    monkeypatch.setattr(assets, "preview", lambda key: tmp_path / f"{key}.png")
    assert assets.missing_previews() == [*PRESETS, *SHOWN]
