"""The NDF map: distributions of half vectors that are images, against quadratures of their own and closed forms."""
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from optics.directions import binned, directions
from optics.images import grid, letter, spot, written
from scipy import stats
from truth.hemisphere import even_lights

from addon import cli
from addon.brdf import MODELS
from addon.dev.compare import properties
from addon.fitting import match as matching
from addon.forms.albedo import tables
from addon.forms.rows import row_bake
from addon.library import star
from addon.models import exr, half_map, images
from addon.models.errors import ImageError, ParameterError

MODEL = MODELS["ndf_map"]


def at_half(x, y):
    """View (3,) and light (3,), both 0.3 radians from the half vector over (x, y)."""
    h = np.array([x, y, math.sqrt(1.0 - x * x - y * y)])
    side = np.cross(h, [0.2, 0.9, 0.1])
    side *= math.sin(0.3) / np.linalg.norm(side)
    return h * math.cos(0.3) + side, h * math.cos(0.3) - side


def density_at(x, y, **given):
    """p at the half vector over (x, y), from f at a pair of directions around it."""
    view, light = at_half(x, y)
    return float(MODEL.evaluate(view, light, **given)[0]) * 4.0 * math.cos(0.3) * max(view[2], light[2])


# The distribution.

PICTURES = {"star": lambda: star.star()[..., 1], "spot": spot, "letter": letter, "even": lambda: np.ones((8, 8)),
            "few": lambda: np.random.default_rng(1).random((5, 5)), "many": lambda: letter(500),
            "odd": lambda: spot(317, x=-0.5, y=0.7, width=0.03)}


@pytest.mark.parametrize("name", PICTURES)
def test_the_integral_is_one(name):
    """Over the hemisphere by rings of the half vector's angle, 1500 times 1500, within 3e-4."""
    p = half_map.of_image(np.asarray(PICTURES[name](), np.float64), turn=0.3)
    theta, phi = (np.arange(1500) + 0.5) * math.pi / 3000.0, (np.arange(1500) + 0.5) * math.pi / 750.0
    total = 0.0
    for t in theta:
        s = math.sin(t)
        h = np.stack([s * np.cos(phi), s * np.sin(phi), np.full(1500, math.cos(t))], axis=-1)
        total += p.density(h).mean() * 2.0 * math.pi * s * math.pi / 3000.0
    assert total == pytest.approx(1.0, abs=3e-4)


def test_known_densities(tmp_path):
    """An even image is 1/(2 pi); pixels' own centres hold their values in proportion, and brightness is no matter."""
    even = written(tmp_path, np.full((16, 16), 7.0))
    assert density_at(0.3, -0.4, image=even) == pytest.approx(0.5 / math.pi, rel=1e-4)
    pixels = np.random.default_rng(2).random((32, 32))
    one, bright = written(tmp_path, pixels), written(tmp_path, 1000.0 * pixels, "bright.exr")
    x, y = grid(32)
    a, b = (10, 14), (20, 9)
    found = [density_at(x[at], y[at], image=one) for at in (a, b)]
    assert found[0] / found[1] == pytest.approx(pixels[a] / pixels[b], rel=1e-5)
    assert density_at(0.1, 0.2, image=bright) == pytest.approx(density_at(0.1, 0.2, image=one), rel=1e-5)
    between = density_at(0.5 * (x[a] + x[10, 15]), y[a], image=one) / found[0]
    assert between == pytest.approx(0.5 * (1.0 + pixels[10, 15] / pixels[a]), rel=1e-5)


def test_right_is_the_tangent_and_up_is_across(tmp_path):
    image = written(tmp_path, spot())
    assert density_at(0.35, 0.15, image=image) > 50.0
    for x, y in ((0.35, -0.15), (-0.35, 0.15), (0.15, 0.35)):
        assert density_at(x, y, image=image) < 1e-6
    assert density_at(-0.15, 0.35, image=image, rotation=0.25) == pytest.approx(density_at(0.35, 0.15, image=image))
    assert not half_map.load(image).is_mirrored and half_map.load(tables.PACKAGED / "ndf_star.exr").is_mirrored
    turned = half_map.load(tables.PACKAGED / "ndf_star.exr", turn=0.5)
    assert not turned.is_mirrored


@pytest.mark.parametrize("n", [6.0, 60.0])
def test_a_power_of_the_cosine_is_ashikhmin_and_shirleys_lobe(tmp_path, n):
    """(N·H)^n as an image: their model with both exponents n, white, within the bend of p between two pixels."""
    x, y = grid(256)
    image = written(tmp_path, np.maximum(1.0 - x * x - y * y, 0.0) ** (0.5 * n))
    view, light = directions(500, seed=1), directions(500, seed=2)
    light[::2] = view[::2] * [-1.0, -1.0, 1.0] + 0.2 * light[::2]
    light /= np.linalg.norm(light, axis=1, keepdims=True)
    theirs = MODELS["ashikhmin_shirley"].evaluate(view, light, exponent_u=n, exponent_v=n)
    ours = MODEL.evaluate(view, light, image=image)
    upright = (view + light)[:, 2] / np.linalg.norm(view + light, axis=1) > 0.2  # the rim has pixels from both sides
    # The largest second derivative of p times a pixel squared over eight, twice for two directions.
    bend = 2.0 * n * (n + 1.0) / (2.0 * math.pi) * (2.0 / 256.0) ** 2 / 8.0
    scale = 4.0 * (view * (view + light)).sum(axis=1) / np.linalg.norm(view + light, axis=1)
    scale = scale * np.maximum(view[:, 2], light[:, 2])
    assert theirs.max() > 1.0 and upright.sum() > 400
    difference, allowed = np.abs(ours - theirs) * scale, bend + 3e-4 * theirs * scale
    assert (difference <= allowed)[upright].all()


@pytest.mark.parametrize("picture", [spot, letter], ids=["spot", "letter"])
def test_unsymmetric_images_are_reciprocal_and_conserve_energy(tmp_path, picture):
    """f(V, L) = f(L, V); no albedo passes 1; each is that of an even quadrature over the lights."""
    image = written(tmp_path, picture())
    view, light = directions(400, seed=3), directions(400, seed=4)
    np.testing.assert_allclose(MODEL.evaluate(view, light, image=image), MODEL.evaluate(light, view, image=image),
                               rtol=1e-9, atol=1e-12)
    given = {"image": image, "base_color": (0.5, 0.2, 0.1), "fresnel_type": "schlick", "diffuse_color": (0.0, 0.1, 0.2)}
    x, area = even_lights(None, None, None, nodes=1200)
    for v in ((0.0, 0.0, 1.0), (0.8, 0.0, 0.6), (-0.48, 0.64, 0.6)):
        expected = (area * x[:, 2]) @ MODEL.evaluate(v, x, **given)
        found = MODEL.albedo_from(np.array(v), MODEL.resolve(given))
        np.testing.assert_allclose(found, expected, rtol=2e-3)
    white = MODEL.resolve({"image": image})
    assert max(MODEL.albedo_from(v, white) for v in directions(60, seed=5)) <= 1.0 + 1e-9


@pytest.mark.parametrize("rotation", [0.0, 0.1])
def test_samples_of_an_unsymmetric_image(tmp_path, rotation):
    """Chi-square over bins of the sphere, what is expected by integrating .pdf evenly; f N·L / pdf is the albedo."""
    given = {"image": written(tmp_path, letter(48)), "rotation": rotation}
    view, count = np.array([0.6, 0.0, 0.8]), 20000
    light = MODEL.sample(view, np.random.default_rng(6).random((count, 2)), **given)
    pdf = MODEL.pdf(view, light, **given)
    value = MODEL.evaluate(view, light, **given) * np.maximum(light[:, 2], 0.0) / pdf
    albedo = MODEL.albedo_from(view, MODEL.resolve(given))
    assert abs(value.mean() - albedo) < 5.0 * value.std() / math.sqrt(count)
    upper, area = even_lights(None, None, None, nodes=900)
    both, area = np.concatenate([upper, upper * [1.0, 1.0, -1.0]]), np.concatenate([area, area])
    wanted = binned(both, MODEL.pdf(view, both, **given) * area) * count
    assert wanted.sum() == pytest.approx(count, rel=2e-3)
    found, often = binned(light), wanted > 10.0
    chi2 = ((found - wanted)[often] ** 2 / wanted[often]).sum()
    assert often.sum() > 8 and stats.chi2.sf(chi2, often.sum()) > 1e-5


# Files.


def test_the_shipped_image_is_what_its_function_draws(table_folder, capsys):
    assert cli.main(["bake", "--star", "--output", str(table_folder)]) == 0
    path = table_folder / "ndf_star.exr"
    assert capsys.readouterr().out == f"{path}\n"
    pixels, metadata = exr.read(tables.PACKAGED / "ndf_star.exr")
    # exp differs by a rounding between processors.
    np.testing.assert_allclose(exr.read(path)[0], pixels, rtol=1e-6, atol=1e-9)
    assert "ndf_map" in metadata["plausible:model"] and "exp" in metadata["plausible:formula"]
    # Points to the right and at 60 degrees, none at 30; brightest in the middle.
    right, slanted, between = (density_at(0.3 * math.cos(a), 0.3 * math.sin(a)) for a in np.radians((0.0, 60.0, 30.0)))
    assert right == pytest.approx(slanted, rel=0.05) and right > 4.0 * between and density_at(0.0, 0.0) > 10.0 * right


def test_other_formats(tmp_path):
    """A painted PNG counts by its light, not its numbers; half floats and images without alpha are read too."""
    oiio = pytest.importorskip("OpenImageIO")
    light = np.repeat(np.clip(letter(), 0.0, 1.0)[..., None], 3, axis=2)

    def save(name, pixels, depth, channels):
        path = tmp_path / name
        file = oiio.ImageOutput.create(str(path))
        file.open(str(path), oiio.ImageSpec(64, 64, channels, depth))
        file.write_image(np.ascontiguousarray(pixels[..., :channels], dtype=np.float32))
        file.close()
        return images.luminance(path)

    srgb = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 1e-9) ** (1.0 / 2.4) - 0.055)
    np.testing.assert_allclose(save("a.png", srgb, "uint8", 3), light[..., 0], atol=5e-3)
    np.testing.assert_allclose(save("b.png", srgb, "uint16", 1), light[..., 0], atol=5e-5)
    np.testing.assert_allclose(save("c.exr", light, "half", 3), light[..., 0], atol=5e-4)
    coloured = save("d.exr", np.stack([0.0 * light[..., 0], light[..., 0], 0.0 * light[..., 0]], axis=-1), "float", 3)
    np.testing.assert_allclose(coloured, 0.7152 * light[..., 0], atol=1e-6)


def of_pixels(**pixels):
    gray = np.ones((8, 8))
    for at, value in pixels.items():
        gray[int(at[1]), int(at[2])] = value
    return gray


@pytest.mark.parametrize("gray, code", [
    (np.ones((8, 9)), "square"), (np.zeros((8, 8)), "black"), (of_pixels(p34=-0.25), "pixel"),
    (of_pixels(p34=np.nan), "pixel"), (of_pixels(p34=np.inf), "pixel"), (np.ones((1, 1)), "size"),
])
def test_images_of_no_use(tmp_path, gray, code, capsys):
    image = written(tmp_path, gray)
    up = [0.0, 0.0, 1.0]
    for call in (lambda: MODEL.evaluate(up, up, image=image), lambda: MODEL.albedo(1.0, image=image),
                 lambda: row_bake.bake(MODEL, {"image": image})):
        with pytest.raises(ImageError) as caught:
            call()
        assert caught.value.code == code and caught.value.path == Path(image)
        assert "\n" not in str(caught.value) and image in str(caught.value)
    assert cli.main(["match", "--from", "ndf_map", "--to", "ward", "--set", f"image={image}"]) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and image in printed.err and printed.err.count("\n") == 1


def test_files_that_are_no_images(tmp_path, monkeypatch):
    text = tmp_path / "text.png"
    text.write_text("no picture")
    for image, code in ((tmp_path / "gone.exr", "missing"), (tmp_path, "missing"), (text, "format")):
        with pytest.raises(ImageError) as caught:
            MODEL.albedo(1.0, image=image)
        assert caught.value.code == code and caught.value.path == image
        assert str(image) in str(caught.value) and "\n" not in str(caught.value)
    whole = written(tmp_path, spot())
    cut = tmp_path / "cut.exr"
    cut.write_bytes(Path(whole).read_bytes()[:9000])
    with pytest.raises(ImageError) as caught:
        MODEL.albedo(1.0, image=cut)
    assert caught.value.code in ("format", "damaged") and caught.value.path == cut
    monkeypatch.setitem(sys.modules, "OpenImageIO", None)
    assert MODEL.albedo(1.0, image=whole)[0] > 0.5
    with pytest.raises(ImageError, match="OpenImageIO, which reads others, is missing") as caught:
        MODEL.albedo(1.0, image=text)
    assert caught.value.code == "reader"
    for value in (3.0, (1.0, 2.0), None, "a\nb", b"bytes"):
        with pytest.raises(ParameterError) as caught:
            MODEL.resolve({"image": value})
        assert caught.value.parameter == "image" and caught.value.code == ("path" if value == "a\nb" else "type")


def test_a_changed_file_is_read_again(tmp_path):
    image, parameter = written(tmp_path, spot()), MODEL.parameter("image")
    before, stamp = density_at(0.35, 0.15, image=image), parameter.stamp(image)
    assert parameter.stamp(image) == stamp != () == parameter.stamp("") == parameter.stamp(str(tmp_path / "gone"))
    written(tmp_path, np.ones((32, 32)))
    assert parameter.stamp(image) != stamp and before > 50.0
    assert density_at(0.35, 0.15, image=image) == pytest.approx(0.5 / math.pi, rel=1e-3)


# What other commands make of it.


def test_no_parameter_widens_it():
    with pytest.raises(ValueError, match="ndf_map: no parameter changes how wide"):
        matching.match("ward", {}, "ndf_map")
    held = matching.match("ward", {"base_color": 0.5}, "ndf_map", hold=True)
    assert held.parameters["image"] == "" and held.parameters["base_color"] == (0.5, 0.5, 0.5) and held.held == ()
    away = matching.match("ndf_map", {}, "ward")
    assert away.dropped == ("image",) and away.half_angles == pytest.approx(away.wanted, rel=1e-4)
    row = properties.measure(MODEL)
    assert row.conserves and row.conformity is None and row.reciprocity_error < 1e-9 and row.anisotropy > 0.05
