"""The small pictures of models and presets: one of each, small enough, in the zip, and icons of the panel's menus."""
import struct

import pytest

from addon import assets, cli
from addon.brdf import MODELS
from addon.dev.packaging import archive
from addon.library.presets import PRESETS

PATHS = [assets.preview(key) for key in (*MODELS, *PRESETS)]


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_there_is_one_of_each(path):
    assert path.is_file(), f"run `plausible previews {path.stem}`"
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n" and data[12:16] == b"IHDR"
    width, height, depth, kind = struct.unpack(">IIBB", data[16:26])
    assert (width, height, depth, kind) == (128, 128, 8, 3)  # a palette
    assert len(data) < 12 * 1024
    assert path.relative_to(archive.ROOT).as_posix() in archive.files()


def test_no_others_are_there():
    assert not set(MODELS) & set(PRESETS)
    assert sorted(assets.PREVIEWS.rglob("*.png")) == sorted(PATHS)


def test_no_two_are_alike():
    assert len({path.read_bytes() for path in PATHS}) == len(PATHS)


def test_a_name_that_is_none(capsys):
    assert cli.main(["previews", "nothing"]) == 2
    assert "no model or preset 'nothing'; there are phong, " in capsys.readouterr().err


@pytest.mark.blender
def test_looks_are_valid():
    pytest.importorskip("bpy")
    from addon.dev.demo import previews

    for model_id, model in MODELS.items():
        model.resolve(previews.look(model_id))
    gold, copper = previews.look("phong"), previews.look("pumped_phong")
    assert gold["ior"] != copper["ior"] and gold["fresnel_type"] == "conductor"


@pytest.mark.blender
def test_rendering_one(tmp_path):
    """A ball in the middle before the ground's colour, redder where it is copper; an older file is replaced."""
    pytest.importorskip("bpy")
    image = pytest.importorskip("PIL.Image")
    from addon.dev.demo import previews

    path = assets.preview("pumped_blinn", tmp_path)
    path.write_bytes(b"old")
    previews.render(path, "pumped_blinn", previews.look("pumped_blinn"))
    with image.open(path) as found:
        assert found.size == (previews.SIDE, previews.SIDE) and found.mode == "P"
        pixels = found.convert("RGB")
    red, _, blue = pixels.getpixel((64, 64))
    assert red > 1.1 * blue
    assert max(abs(a - b) for a, b in zip(pixels.getpixel((3, 3)), previews.BACKGROUND, strict=True)) <= 4
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.blender
def test_icons_come_and_go(monkeypatch):
    """None in background mode; where they are, models and presets have theirs, and what has no file has none."""
    bpy = pytest.importorskip("bpy")
    from addon.blender.ui import icons, properties

    assert bpy.app.background
    icons.start()
    assert icons._pictures is None and icons.icon_of("phong") == 0
    icons.start(in_background=True)
    assert list(icons._pictures) == [*MODELS, *PRESETS]
    # Icons have no numbers without a window: any will do to see that each item has its own.
    monkeypatch.setattr(icons, "icon_of", lambda key: 1000 + [*MODELS, *PRESETS].index(key))
    properties.prepare()
    declared = properties.PlausibleMaterial.__annotations__["model"]
    assert [item[3] for item in declared.keywords["items"]] == [1000 + i for i in range(len(MODELS))]
    assert [item[4] for item in declared.keywords["items"]] == list(range(len(MODELS)))
    monkeypatch.undo()
    icons.stop()
    assert icons._pictures is None and icons.icon_of("phong") == 0
    properties.prepare()


@pytest.mark.blender
def test_a_file_that_is_missing(monkeypatch, tmp_path):
    """Its item has no icon, and all else is as it was."""
    pytest.importorskip("bpy")
    from addon.blender.ui import icons

    monkeypatch.setattr(assets, "preview", lambda key: tmp_path / f"{key}.png" if key in MODELS else PATHS[-1])
    icons.start(in_background=True)
    assert list(icons._pictures) == list(PRESETS)
    assert icons.icon_of("phong") == 0
    icons.stop()
