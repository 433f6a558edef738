"""Whether the tests find wrong factors: one at a time is put into a copy of the tree, and tests that should fail run.

    ./run mutate                      all
    ./run mutate NAME...              these
    ./run mutate --list               what there is
    ./run mutate --workers 4 --write  four at once; the table goes into docs/mutations.md

A mutation replaces a text, which stands in its file exactly once, or spoils a table. It is caught where an assertion
fails: that the mutant cannot be imported or compiled does not count. First all tests named here are run on the tree as
it is, and must pass. The exit code is 1 where a mutation survives.
"""
import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import Queue

ROOT = Path(__file__).resolve().parents[1]
COPIED = ("addon", "osl", "luts", "tests", "__init__.py", "blender_manifest.toml", "pyproject.toml", "README.md")
LIMIT, LIMIT_OF_ALL = 300.0, 1800.0  # seconds: for the tests of one mutant, and for all of them on the tree as it is
# How pytest's summary names a failed assertion; a SyntaxError or an ImportError has other words.
_ASSERTION = re.compile(r"^FAILED (\S+?\.py::\S.*?) - (?:assert|AssertionError|Failed: DID NOT RAISE)", re.MULTILINE)
_WRONG = re.compile(r"^(?:FAILED|ERROR) .*", re.MULTILINE)


@dataclass(frozen=True)
class Mutation:
    """`old` in `file` becomes `new`, or `spoil(path)` changes the file; `tests`, pytest's names, should notice."""

    name: str
    file: str
    old: str
    new: str
    tests: tuple
    spoil: object = None

    def apply(self, root: Path):
        """Change the file below `root`. Raises ValueError where `old` does not stand in it exactly once."""
        path = root / self.file
        if self.spoil:
            self.spoil(path)
            return
        text = path.read_text(encoding="utf-8")
        if text.count(self.old) != 1:
            raise ValueError(f"{self.name}: {self.old!r} stands {text.count(self.old)} times in {self.file}, not once")
        path.write_text(text.replace(self.old, self.new), encoding="utf-8")


def _in(module, *names):
    return tuple(f"tests/test_{module}.py::{name}" for name in names)


# Formulas.

_EVALUATE = _in("models", "test_evaluate_is_the_formula")
_FORMULA = _in("literature", "test_formula")
_LITERATURE_PDF = _in("literature", "test_samples_follow_the_pdf")
_LOBES, _DISK, _SAMPLERS = "addon/models/lobes.py", "addon/models/disk.py", "addon/models/samplers.py"
_MODELS = "addon/models/formulas"

FORMULAS = (
    Mutation("phong-normalisation", _LOBES,
             "return (n + 2.0) / TWO_PI * np.maximum(dot(mirror(view), light), 0.0) ** n",
             "return (n + 1.0) / TWO_PI * np.maximum(dot(mirror(view), light), 0.0) ** n", _EVALUATE),
    Mutation("blinn-normalisation", _LOBES,
             "return (n + 8.0) / (8.0 * np.pi) * np.maximum(half(view, light)[:, 2], 0.0) ** n",
             "return (n + 7.9) / (8.0 * np.pi) * np.maximum(half(view, light)[:, 2], 0.0) ** n", _EVALUATE),
    Mutation("phong-power-of-angles", _LOBES, "np.maximum(mirror_dot_light, 0.0) ** n",
             "np.maximum(mirror_dot_light, 0.0) ** (1.02 * n)", _in("models",
             "test_albedo_is_the_integral_of_evaluate")),
    Mutation("blinn-without-horizon-clamp", _LOBES, "/ (4.0 * np.maximum(dot(view, h), 1e-12))",
             "/ (4.0 * np.maximum(h[:, 2], 1e-12))", _in("models", "test_samples_follow_the_pdf")),
    Mutation("reciprocal-disk-square", _LOBES,
             "shared = 2.0 * np.sqrt(np.maximum(mu_view * mu_light, 1e-300)) * up2**1.5",
             "shared = 2.0 * np.sqrt(np.maximum(mu_view * mu_view, 1e-300)) * up2**1.5",
             _in("disk", "test_lumps_are_not_reciprocal_and_the_reciprocal_disk_is")),
    Mutation("axis-power-density", _SAMPLERS, "return (self.exponent + 1.0) / TWO_PI * np.maximum(",
             "return (self.exponent + 2.0) / TWO_PI * np.maximum(",
             _in("models", "test_pdf_is_a_density_over_the_sphere")),
    Mutation("blinn-sampling", _LOBES, "around(normal, u[:, 0] ** (1.0 / (n + 1.0)), TWO_PI * u[:, 1])",
             "around(normal, u[:, 0] ** (1.0 / (n + 1.2)), TWO_PI * u[:, 1])",
             _in("models", "test_samples_follow_the_pdf")),
    Mutation("half-vector-jacobian", _SAMPLERS, "(4.0 * np.maximum(np.abs(dot(view, h)), 1e-12))",
             "(4.0 * np.maximum(np.abs(h[:, 2]), 1e-12))", _LITERATURE_PDF),
    Mutation("beckmann-axes-swapped", _SAMPLERS, "[self.mx * radius * np.cos(turn), self.my * radius * np.sin(turn)]",
             "[self.my * radius * np.cos(turn), self.mx * radius * np.sin(turn)]", _LITERATURE_PDF),
    Mutation("lambert-sampling", _SAMPLERS, "radius, phi = np.sqrt(1.0 - u[:, 0]), TWO_PI * u[:, 1]",
             "radius, phi = np.sqrt(1.0 - u[:, 0] ** 1.1), TWO_PI * u[:, 1]", _in("literature",
             "test_samples_follow_the_pdf[kajiya_kay-default-0.8]")),
    Mutation("scaling-measure", _DISK, "return view[:, 2] ** 2 / half(view, light)[:, 2] ** 3",
             "return view[:, 2] ** 2 / half(view, light)[:, 2] ** 2", _in("disk", "test_jacobian_by_differences")),
    Mutation("orthogonal-without-cosine", _DISK, "return dot(total, total) * light[:, 2] / np.maximum(dot(light,",
             "return dot(total, total) / np.maximum(dot(light,", _in("disk", "test_jacobian_by_differences")),
    Mutation("scaling-view-for-light", _DISK, "return view[:, 2:] / total[:, 2:] * total[:, :2]",
             "return light[:, 2:] / total[:, 2:] * total[:, :2]",
             _in("disk", "test_point_and_light_are_each_others_inverse")),
    Mutation("lump-normalisation", _DISK, "return (n + 1.0) / (np.pi * radii[..., 0] * radii[..., 1]) * power",
             "return (n + 1.01) / (np.pi * radii[..., 0] * radii[..., 1]) * power",
             _in("disk", "test_lump_has_volume_one_and_its_samples_follow_it")),
    Mutation("lump-turned-the-other-way", _DISK, "return np.array([[cos, sin], [-sin, cos]])",
             "return np.array([[cos, -sin], [sin, cos]])", _in("disk", "test_evaluate_is_the_formula")),
    Mutation("grazing-exponent", "addon/models/disk_model.py", "return (normal + 1.0) ** mu_view",
             "return (normal + 1.1) ** mu_view",
             _in("disk", "test_exponents_that_vary_with_the_angle")),
    Mutation("fresnel-at-the-light", "addon/models/disk_model.py",
             "return self._coloured(view[:, 2], disk.value(", "return self._coloured(light[:, 2], disk.value(",
             _in("disk", "test_empirical_is_equation_33")),
    Mutation("volume-row", "addon/forms/albedo/tables.py",
             "table.rows, column, n + 1.0)[..., k % CHANNELS]", "table.rows, column, n + 1.1)[..., k % CHANNELS]",
             _in("disk", "test_volume_table_is_the_volume")),
    Mutation("pumping-share", "addon/models/pumping.py", "albedos_light[..., stage]) ** share",
             "albedos_light[..., stage]) ** share**1.02", _in("pumping", "test_correction_by_hand")),
    Mutation("pumping-smaller-albedo", "addon/models/pumping.py",
             "d = d * np.maximum(albedos_view[..., stage], albedos_light[..., stage])",
             "d = d * np.minimum(albedos_view[..., stage], albedos_light[..., stage])",
             _in("pumping", "test_plain_phong_has_the_checked_albedos", "test_correction_by_hand")),
    Mutation("pumping-control-once", "addon/models/pumping.py", "        if control:\n",
             "        if control and not stage:\n",
             _in("pumping", "test_correction_by_hand", "test_controlled_phong_ends_at_the_limit_after_two_pumps")),
    Mutation("pumped-formula-at-the-view", "addon/models/pumping.py",
             "return correction(at_view, at_light, mu_view, mu_light, pumps, control)",
             "return correction(at_view, at_view, mu_view, mu_light, pumps, control)",
             _in("literature", "test_the_one_mechanism_pumps_as_tables_do",
                 "test_pumping_conserves_any_symmetric_formula")),
    Mutation("schlick-power", "addon/models/fresnel.py", "(1.0 - mu) ** 5", "(1.0 - mu) ** 4.9",
             _in("models", "test_schlick_runs_from_colour_to_edge", "test_colour_factor_depends_on_view_and_half")),
    Mutation("conductor-extinction", "addon/models/fresnel.py", "4.0 * n * n * k * k", "3.9 * n * n * k * k",
             _in("models", "test_conductor_is_fresnel_with_a_complex_index")),
    Mutation("roughness-to-exponent", "addon/models/parameters.py",
             "/ (alpha * alpha) - BECKMANN_POWER, MIN_EXPONENT", "/ (alpha * alpha) - 1.0, MIN_EXPONENT",
             _in("models", "test_roughness_and_exponent")),
    Mutation("ward-cosine", f"{_MODELS}/ward.py", "* 0.25 * h[:, 2] ** 4", "* 0.25 * h[:, 2] ** 3", _FORMULA),
    Mutation("grooves-without-clamp", "addon/models/microfacet.py",
             "return np.minimum(1.0, 2.0 * h[:, 2] * lower / np.maximum(dot(view, h), 1e-12))",
             "return 2.0 * h[:, 2] * lower / np.maximum(dot(view, h), 1e-12)", _FORMULA),
    Mutation("smith-tail", "addon/models/microfacet.py",
             "(a * np.sqrt(np.pi)) - erfc(a)", "(a * np.sqrt(3.1)) - erfc(a)",
             _FORMULA),
    Mutation("cosine-microfacet-normalisation", f"{_MODELS}/cook_torrance.py",
             "return (n + 2.0) / (8.0 * np.pi) * power", "return (n + 2.1) / (8.0 * np.pi) * power", _FORMULA),
    Mutation("he-torrance-series", f"{_MODELS}/he_torrance.py", "- x / m -", "- x / (m + 0.02) -", _FORMULA),
    Mutation("he-torrance-shadow", f"{_MODELS}/he_torrance.py", "k(mu_view) + k(mu_light)", "k(mu_view) + k(mu_view)",
             _FORMULA + _in("literature", "test_reciprocity")),
    Mutation("embrechts-masking", f"{_MODELS}/embrechts.py",
             "smith_beckmann(view[:, 2], m) * smith_beckmann(light[:, 2], m)",
             "smith_beckmann(view[:, 2], m) * smith_beckmann(view[:, 2], m)", _FORMULA),
    Mutation("ashikhmin-diffuse", f"{_MODELS}/ashikhmin_shirley.py", "28.0 / (23.0 * np.pi)", "28.0 / (22.8 * np.pi)",
             _FORMULA),
    Mutation("ashikhmin-quadrants", _SAMPLERS, "np.arctan2(np.sqrt(self.nu + 1.0)", "np.arctan2(np.sqrt(self.nu + 2.0)",
             _in("literature", "test_half_vectors_of_a_power_go_around_as_their_density_says")),
    Mutation("lafortune-sign", f"{_MODELS}/lafortune.py", "view[:, 0] * light[:, 0] + view[:, 1] * light[:, 1]",
             "view[:, 0] * light[:, 0] - view[:, 1] * light[:, 1]", _FORMULA),
    Mutation("kajiya-kay-cone", f"{_MODELS}/kajiya_kay.py", "sine_v * sine_l - view[:, 0] * light[:, 0]",
             "sine_v * sine_l + view[:, 0] * light[:, 0]", _FORMULA),
    Mutation("map-turn", "addon/models/half_map.py", "_turned(h, -self.turn), len(", "_turned(h, self.turn), len(",
             _in("ndf_map", "test_samples_of_an_unsymmetric_image", "test_right_is_the_tangent_and_up_is_across")),
    Mutation("map-pixel-centre", "addon/models/half_map.py", "0.5 * size * (h[..., i] + 1.0) - 0.5",
             "0.5 * size * (h[..., i] + 1.0) - 0.4", _in("ndf_map", "test_the_integral_is_one",
             "test_known_densities")),
    Mutation("quadrature-weight", "addon/models/quadrature.py", "weights = width * (w * 6.0 * s * (1.0 - s))",
             "weights = width * (w * 6.01 * s * (1.0 - s))", _in("baking", "test_albedos_known_in_closed_form")),
    Mutation("gold-index", "addon/library/metals.py", "f0=(1.0000, 0.7840, 0.3425)", "f0=(1.0000, 0.7740, 0.3425)",
             _in("metals", "test_conductor_formula_reproduces_the_reflectances")),
    Mutation("preset-of-another-metal", "addon/library/presets.py",
             "{\"diffuse_color\": BLACK, \"base_color\": METALS[\"aluminium\"].f0",
             "{\"diffuse_color\": BLACK, \"base_color\": METALS[\"silver\"].f0", _in("presets",
             "test_metal_has_its_measured_colour")),
)


# Tables and what is baked.

def _texel(path):
    """One albedo of one exponent is 1e-4 too high."""
    from addon.models import exr

    image, metadata = exr.read(path)
    image = image.copy()
    row = 1 + 23  # behind the marker; that of n = 20, which a test looks at. `plausible bake --check` looks at all
    image[row, 30, 0] *= 1.0001
    exr.write(path, image, metadata)


def _columns_backwards(path):
    """All rows between the markers are read from the normal to grazing."""
    from addon.models import exr

    image, metadata = exr.read(path)
    image = image.copy()
    image[1:-1] = image[1:-1, ::-1]
    exr.write(path, image, metadata)


def _rows_shifted(path):
    """Each row has the albedos of the next."""
    from addon.models import exr

    image, metadata = exr.read(path)
    image = image.copy()
    image[1:-2] = image[2:-1]
    exr.write(path, image, metadata)


def _told_error(path):
    """The metadata tell half of the error."""
    from addon.models import exr

    image, metadata = exr.read(path)
    first, number, rest = metadata["plausible:error"].split(" ", 2)
    exr.write(path, image, {**metadata, "plausible:error": f"{first} {0.5 * float(number):.1e} {rest}"})


def _base_level(path):
    """The largest number of one node of the base lobes is 2 % too large."""
    document = json.loads(path.read_text(encoding="utf-8"))
    family = document["families"]["phong"]
    node = len(family["table"]) // (family["u_nodes"] * family["v_nodes"])
    first = node * (6 * family["v_nodes"] + 4)
    largest = max(range(first, first + node), key=lambda i: abs(family["table"][i]))
    family["table"][largest] *= 1.02
    path.write_text(json.dumps(document, separators=(",", ":")) + "\n", encoding="utf-8")


def _bell_share(path):
    """The inner ring of bells of n = 1 has a tenth too much."""
    document = json.loads(path.read_text(encoding="utf-8"))
    document["table"][10][2] *= 1.1
    path.write_text(json.dumps(document, separators=(",", ":")) + "\n", encoding="utf-8")


_AGAIN = _in("baking", "test_a_row_baked_again_is_the_same")
_LOBE_ROWS = "addon/forms/rows"
_ROWS = _in("weights", "test_rows_are_the_formula")

TABLES = (
    Mutation("table-texel", "luts/phong_plain.exr", "", "", _in(
        "baking", "test_first_albedos_by_scipy", "test_shipped_rows_are_within_their_bounds"), _texel),
    Mutation("table-columns-backwards", "luts/blinn_plain.exr", "", "", _in(
        "baking", "test_first_albedos_by_scipy"), _columns_backwards),
    Mutation("table-rows-shifted", "luts/disk_plain.exr", "", "", _AGAIN, _rows_shifted),
    Mutation("table-tells-another-error", "luts/blinn_controlled.exr", "", "", _in(
        "panel", "test_menu_and_preferences_draw"), _told_error),
    Mutation("base-lobes-number", "luts/base_lobes.json", "", "", _in(
        "base_lobes", "test_base_is_near_the_target", "test_a_node_fitted_again_is_the_shipped"), _base_level),
    Mutation("bells-number", "luts/bells.json", "", "", _in(
        "bells", "test_bells_hold_what_their_shares_say",
        "test_bells_are_hardly_above_the_lump_and_many_leave_less_than_few"),
        _bell_share),
    Mutation("row-law", "addon/forms/albedo/axes.py", "low, high = [(start - row * step) ** (self.law / self.density)",
             "low, high = [(start - row * step) ** (1.1 * self.law / self.density)",
             _in("tables", "test_position_of_every_node_is_its_number",
                 "test_reading_blends_two_rows_and_two_columns")),
    Mutation("column-blend", "addon/forms/albedo/axes.py", "return row[i] + (x - i)[..., None] * (row[i + 1] - row[i])",
             "return row[i] + (x - i)[..., None] * (row[i] - row[i - 1])",
             _in("tables", "test_reading_blends_two_rows_and_two_columns")),
    Mutation("chain-interpolation", "addon/models/interpolation.py",
             "return [before[i] * after[POINTS - 1 - i] / alone[i] for i in range(POINTS)]",
             "return [before[i] * after[POINTS - 1 - i] / (alone[i] + 0.01 * i) for i in range(POINTS)]",
             _AGAIN + _in("albedos", "test_reading_between_the_nodes_of_a_curve")),
    Mutation("chain-stage", "addon/models/pumping.py",
             "mu_view[:, None], mu_light, stage, control)\n        albedos[:, stage]",
             "mu_view[:, None], mu_light, stage - 0.01, control)\n        albedos[:, stage]", _AGAIN),
    Mutation("kink-elsewhere", "addon/models/pump_stages.py", "m[i] + before / (before - after) * (m[i + 1] - m[i])",
             "m[i + 1] + before / (before - after) * (m[i + 1] - m[i])",
             _in("albedos", "test_reading_between_the_nodes_of_a_curve")),
    Mutation("albedo-across-kinks", "addon/models/lobe_model.py", "azimuthal=48, edges=edges)", "azimuthal=48)",
             _in("albedos", "test_the_albedo_of_a_whole_pump_is_the_next_stage")),
    Mutation("integrated-volume", "addon/models/albedos.py", ".at(distance[chosen] / r)",
             ".at(1.001 * distance[chosen] / r)", _in("albedos", "test_volumes_are_those_of_the_lump")),
    Mutation("volume-exponent", "addon/forms/albedo/volume_rows.py", "return np.stack([volume(m - 1.0, r, columns)",
             "return np.stack([volume(m - 0.99, r, columns)", _AGAIN),
    Mutation("weights-without-cosine", f"{_LOBE_ROWS}/view_slice.py",
             "value * (4.0 * light[lit][:, 2] * (half[lit] @ view))[:, None]",
             "value * (4.0 * (half[lit] @ view))[:, None]", _ROWS),
    Mutation("weights-one-percent", f"{_LOBE_ROWS}/residual.py", "energies = energies * view_slice.layout.cell_rings",
             "energies = 0.95 * energies * view_slice.layout.cell_rings",
             _ROWS + _in("weights_error", "test_the_albedo_between_rows")),
    Mutation("facet-masking", f"{_LOBE_ROWS}/facets.py", "1.0 + _lambda(v, widths) + _lambda(lit, widths)",
             "1.0 + _lambda(v, widths) + _lambda(v, widths)", _ROWS + _in("weights",
             "test_stretched_rows_are_the_formula")),
    Mutation("facets-in-pairs", f"{_LOBE_ROWS}/facets.py", "facet_value((slopes[0], -slopes[1]), widths, view, light)",
             "facet_value((slopes[0], slopes[1]), widths, view, light)", _ROWS),
    Mutation("base-ramp-height", "addon/forms/base_lobes/closures.py", "height = (m if ramp.crease else e) + 2.0",
             "height = (m if ramp.crease else e) + 1.9", _in("base_lobes", "test_a_node_fitted_again_is_the_shipped")),
    Mutation("bells-not-staggered", "addon/forms/bells.py", "phi = 2.0 * np.pi * (k + 0.5 * (i % 2)) / count",
             "phi = 2.0 * np.pi * k / count",
             _in("bells", "test_bells_are_hardly_above_the_lump_and_many_leave_less_than_few")),
    Mutation("weights-error-one-side", f"{_LOBE_ROWS}/error.py",
             "return (np.abs(off).sum(axis=(0, 1)) / whole).max()",
             "return (np.maximum(off, 0.0).sum(axis=(0, 1)) / whole).max()",
             _in("weights_error", "test_wrong_weights_are_told")),
)


# Shaders.

_INCLUDE = "osl/include"
_PUMPED = _in("render", "test_furnace[pumped_phong-n=1.5 pumps=2 plain]",
              "test_furnace[pumped_phong-n=20 pumps=1 controlled]")
_TURNED = _in("render_disk", "test_point_by_point[disk_scaling-exponent=10 radius_u=1 radius_v=0.3 rotation=0.1-40.0]")

SHADERS = (
    Mutation("shader-phong-normalisation", f"{_INCLUDE}/lobe_phong.h", "return (n + 2.0) / M_2PI * mirror_power",
             "return (n + 2.1) / M_2PI * mirror_power", _PUMPED),
    Mutation("shader-blinn-normalisation", f"{_INCLUDE}/lobe_blinn.h", "return (n + 8.0) / (4.0 * M_2PI)",
             "return (n + 7.9) / (4.0 * M_2PI)", _in("render", "test_furnace[blinn-n=1.5]",
             "test_furnace[pumped_blinn-n=1.5 pumps=2 plain]")),
    Mutation("shader-density", f"{_INCLUDE}/lobe_phong.h", "return (n + 1.0) / M_2PI * mirror_power",
             "return (n + 2.0) / M_2PI * mirror_power", _PUMPED),
    Mutation("shader-divides-twice", f"{_INCLUDE}/estimator.h", "float drawn = aim.draws.chance * at.density;",
             "float drawn = at.density * aim.draws.count;", _PUMPED + _in("render",
             "test_furnace[pumped_phong-n=5000 pumps=0.5 plain]")),
    Mutation("shader-without-cosine", f"{_INCLUDE}/estimator.h",
             "float value = SPOILT_TARGET(lobe) * light[2] / correction(",
             "float value = SPOILT_TARGET(lobe) / correction(", _PUMPED),
    Mutation("shader-makes-light", f"{_INCLUDE}/estimator.h", "    return excess;\n", "    return 0.0 * excess;\n",
             _in("render", "test_what_negative_kernels_cannot_take_away_is_taken_from_the_base")),
    Mutation("shader-same-hash-twice", f"{_INCLUDE}/random.h", "hashnoise(hit, SECOND_HASH + apart)",
             "hashnoise(hit, apart)",
             _in("render", "test_point_by_point[pumped_phong-n=20 pumps=1 controlled-65.0]",
                 "test_sphere_under_a_sun[pumped_phong-n=7 pumps=2 plain]")),
    Mutation("shader-third-hash", f"{_INCLUDE}/random.h", "hashnoise(hit, THIRD_HASH +",
             "hashnoise(hit, SECOND_HASH +",
             _in("osl_random", "test_uniform_and_independent")),
    Mutation("shader-table-row", f"{_INCLUDE}/table.h", "int below = at + TABLE_CHANNELS * r.axes.columns;",
             "int below = at + TABLE_CHANNELS * (r.axes.columns - 1);", _PUMPED),
    Mutation("shader-pump-in-part", f"{_INCLUDE}/correction_pumped.h", "d *= share < 1.0 ? pow(m, share) : m;",
             "d *= m;", _in("render", "test_furnace[pumped_phong-n=1.5 pumps=0.5 controlled]")),
    Mutation("shader-control", f"{_INCLUDE}/correction_pumped.h", "d = max(d, max(c.mu_view, mu_light));",
             "d = max(d, c.mu_view);", _in("render", "test_furnace[pumped_phong-n=7 pumps=2 controlled]",
                                           "test_sphere_under_a_sun[pumped_phong-n=1.5 pumps=1 controlled]")),
    Mutation("shader-schlick", f"{_INCLUDE}/fresnel.h", "pow(1.0 - clamp(mu, 0.0, 1.0), 5.0)",
             "pow(1.0 - clamp(mu, 0.0, 1.0), 4.8)", _in("render", "test_fresnel[schlick-pumped_phong]")),
    Mutation("shader-conductor", f"{_INCLUDE}/fresnel.h", "color t4 = 2.0 * a * mu * sin2;",
             "color t4 = 2.0 * a * mu;", _in("render", "test_fresnel[conductor-pumped_phong]")),
    Mutation("shader-roughness", f"{_INCLUDE}/inputs.h", "return BECKMANN_POWER / (alpha * alpha) - BECKMANN_POWER;",
             "return BECKMANN_POWER / (alpha * alpha) - 1.0;",
             _in("render", "test_roughness_is_another_way_to_say_exponent")),
    Mutation("shader-power-series", f"{_INCLUDE}/power.h", "1.0 + z2 * (1.0 / 3.0 + z2", "1.0 + z2 * (1.0 / 30.0 + z2",
             _PUMPED + _in("render_disk", "test_furnace[disk_scaling-exponent=5]")),
    Mutation("shader-around", f"{_INCLUDE}/geometry.h", "float sin_delta = sqrt(rest * (2.0 - rest));",
             "float sin_delta = sqrt(rest * 2.0);", _PUMPED),
    Mutation("shader-lump-turn", f"{_INCLUDE}/disk.h", "p.along = vector(cos(turn), sin(turn), 0.0);",
             "p.along = vector(cos(turn), -sin(turn), 0.0);", _TURNED),
    Mutation("shader-scaling-measure", f"{_INCLUDE}/disk.h",
             "s.stretch = SPOILT_STRETCH(view[2] * view[2] / (4.0 * along * s.h[2] * s.h[2] * s.h[2]));",
             "s.stretch = SPOILT_STRETCH(view[2] * view[2] / (4.0 * along * s.h[2] * s.h[2]));",
             _TURNED + _in("render_disk", "test_furnace[disk_scaling-exponent=1]")),
    Mutation("shader-orthogonal-measure", f"{_INCLUDE}/disk.h", "s.stretch = s.light[2];",
             "s.stretch = view[2];", _in("render_disk", "test_furnace[disk_orthogonal-exponent=1]")),
    Mutation("shader-grazing-exponent", f"{_INCLUDE}/disk.h",
             "pow(at_normal + 1.0, mu) * pow(grazing + 1.0, 1.0 - mu)",
             "pow(at_normal + 1.0, 1.0 - mu) * pow(grazing + 1.0, mu)",
             _in(
                 "render_disk", "test_point_by_point[edwards_empirical-exponent=5 base_color=1 vary_exponents=True "
                 "grazing_exponent=200-40.0]")),
    Mutation("shader-room", f"{_INCLUDE}/disk.h", "return mu * mu / (1.0 + sqrt(max(1.0 - mu * mu, 0.0)));",
             "return mu * mu / (1.0 + 0.9 * sqrt(max(1.0 - mu * mu, 0.0)));",
             _in("render_disk", "test_furnace[disk_scaling-exponent=1]",
             "test_sphere_under_a_sun[disk_scaling-exponent=5-(0.0, 40.0, 65.0, 80.0)]")),
    Mutation("shader-bell-height", f"{_INCLUDE}/bells.h",
             "b.weight / (4.0 * M_PI * b.alpha_x", "b.weight / (4.1 * M_PI * b.alpha_x",
             _in("render_disk", "test_furnace[disk_orthogonal-exponent=1]")),
    Mutation("shader-rest-density", f"{_INCLUDE}/disk_estimator.h",
             "density += residual_share / (BELL_KNOTS * M_PI * (high - low));",
             "density += residual_share / (BELL_KNOTS * 3.0 * (high - low));", _in("render_disk",
             "test_furnace[disk_scaling-exponent=1]")),
    Mutation("shader-reciprocal", f"{_INCLUDE}/target_reciprocal.h", "sqrt(s.light[2] / mu) / (mu * mu)",
             "(s.light[2] / mu) / (mu * mu)", _in("render_disk", "test_furnace[reciprocal_disk-exponent=7]")),
    Mutation("shader-volume-layer", f"{_INCLUDE}/volume.h", "radii[k] = 1.0 - below * below;",
             "radii[k] = 1.0 - below;",
             _in("render_disk",
             "test_furnace[edwards_fit-base_color=1 f90=1 exponent=5 second_exponent=11 radius=0.8 second_radius=1]")),
    Mutation("shader-renormalised", "osl/edwards_fit.osl", "Row row = table_row(AXES_VOLUME, n + 1.0);",
             "Row row = table_row(AXES_VOLUME, n + 2.0);",
             _in("render_disk",
             "test_furnace[edwards_fit-base_color=1 f90=1 exponent=5 second_exponent=11 radius=0.8 second_radius=1]")),
    Mutation("shader-retro-place", "osl/edwards_empirical.osl",
             "make_lump(vector(d.frame.view[0], d.frame.view[1], 0.0),",
             "make_lump(vector(d.frame.view[0], -d.frame.view[1], 0.0),",
             _in("render_disk", "test_retroreflection_under_a_headlight[50.0]")),
    Mutation("shader-cells-on-one-side", f"{_INCLUDE}/weights.h", "float phi = side * mix(",
             "float phi = abs(side) * mix(",
             _in("render_weights", "test_sphere_under_a_sun[ward-default-0.01-0.003]")),
    Mutation("shader-rows-not-crowded", f"{_INCLUDE}/rows.h", "pow(1.0 - along, 1.0 / W_CROWDED)",
             "pow(1.0 - along, 0.7)",
             _in("render_weights", "test_furnace[ward-default]")),
    Mutation("shader-quadrant", f"{_INCLUDE}/rows.h", "        f.y = -f.y;\n", "        f.y = f.y;\n",
             _in("render_weights", "test_tangent_turns_the_lobe")),
    Mutation("shader-spike-place", f"{_INCLUDE}/weights.h", "float along = W_SPIKES * place;",
             "float along = place;", _in("render_weights", "test_a_mirror_spike_mirrors")),
    Mutation("shader-ranges-in-ratios", f"{_INCLUDE}/rows.h", "geometric ? log(at / least)",
             "!geometric ? log(at / least)", _in("render_ranges", "test_keyframes_are_followed")),
    Mutation("shader-ranges-neighbours", f"{_INCLUDE}/rows.h", "rest = rest / steps[i];", "rest = rest / steps[0];",
             _in("render_ranges", "test_furnace[ward-{'roughness_u': 0.11, 'base_color': (0.9, 0.4, 0.05)}-"
                 "{'roughness_u': (0.1, 0.13)}-{'roughness_v': 0.12}-0.0025]")),
    Mutation("shader-ranges-weight", f"{_INCLUDE}/rows.h", "places, steps) * (all / likely[set]);",
             "places, steps) * 3.0;", _in("render_ranges", "test_a_texture_is_followed_from_point_to_point")),
    Mutation("ranges-steps", f"{_LOBE_ROWS}/grid.py", "(2.0 if ends.parameter.logarithmic else 1.0)",
             "(8.0 if ends.parameter.logarithmic else 1.0)", _in("ranges",
             "test_exponents_go_in_the_squares_of_these")),
)


# Measuring, fitting, standing in.

MEASURES = (
    Mutation("standard-error", "addon/measure/instruments.py", "flat.std(axis=0, ddof=1) / np.sqrt(len(flat))",
             "flat.std(axis=0, ddof=1) / np.sqrt(len(flat) // 2)", _in("verify",
             "test_mean_and_standard_error_of_known_pixels")),
    Mutation("goniometer-without-cosine", "addon/measure/instruments.py",
             "irradiance = scene.SUN_ENERGY * light[2]", "irradiance = scene.SUN_ENERGY",
             _in("verify", "test_goniometer")),
    Mutation("verdict-one-side", "addon/measure/comparison.py", "good = (np.abs(self.error) <= allowed)",
             "good = (self.error <= allowed)", _in("verify", "test_verdicts")),
    Mutation("sun-the-other-way", "addon/measure/instruments.py", "    return geometry.in_plane(-np.asarray(angles_deg",
             "    return geometry.in_plane(np.asarray(angles_deg", _in("verify",
             "test_the_mirrors_side_is_where_the_view_is_not")),
    Mutation("half-of-the-lobe", "addon/fitting/match.py", "<= 0.5 * top", "<= 0.505 * top",
             _in("fitting", "test_half_angles_in_closed_form")),
    Mutation("stand-in-roughness", "addon/blender/backend/principled.py", "nodes.math(\"ADD\", exponent, 2.0)), 0.25)",
             "nodes.math(\"ADD\", exponent, 2.0)), 0.26)", _in("stand_in", "test_its_lobe_is_as_high_as_is_said")),
    Mutation("stand-in-factor", "addon/backends/nodes/principled_fit.py", "\"blinn\": 0.88", "\"blinn\": 0.98",
             _in("principled", "test_factors_of_roughness_are_what_fits_find[blinn]")),
    Mutation("stand-in-schlick", "addon/blender/backend/principled.py",
             "nodes.math(\"POWER\", facing.outputs[\"Facing\"], 5.0)",
             "nodes.math(\"POWER\", facing.outputs[\"Facing\"], 4.5)",
             _in("stand_in", "test_a_body_goes_dark_towards_grazing_as_schlick_says")),
    Mutation("width-by-roughness", "addon/blender/ui/operators/width.py",
             "new[\"roughness\"] = models.roughness_of_exponent(now[\"exponent\"])",
             "new[\"roughness\"] = models.roughness_of_exponent(now[\"exponent\"] + 1.0)",
             _in("switches", "test_the_lobe_keeps_its_width")),
    Mutation("hidden-weights", "addon/backends/osl/assembler.py",
             "return f\"abs({parameter.id} - {value!r}) <= {1e-5 * max(abs(value), 1e-3):.3g}\"",
             "return f\"abs({parameter.id} - {value!r}) <= {1e-1 * max(abs(value), 1e-3):.3g}\"",
             _in("shading", "test_weights_hold_for_their_values_to_single_precision")),
)

MUTATIONS = (*FORMULAS, *TABLES, *SHADERS, *MEASURES)


# Running them.

@dataclass(frozen=True)
class Outcome:
    """`caught` names the test whose assertion failed, "" where none did; `words` say what came out otherwise."""

    mutation: Mutation
    caught: str
    words: str
    seconds: float


def copy_tree(folder: Path):
    """What the tests need, copied into an empty folder."""
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__", "*.blend", "previews"))
        else:
            shutil.copy2(source, folder / name)


def run_tests(root: Path, tests, limit=LIMIT) -> tuple:
    """(exit code, output) of pytest in a copy; code None where it took longer than `limit` seconds."""
    # Sources change while their size and second may not: nothing compiled is kept.
    environment = {**os.environ, "PYTHONPATH": str(root), "PYTHONDONTWRITEBYTECODE": "1", "OPENBLAS_NUM_THREADS": "1",
                   "COLUMNS": "500"}
    command = [sys.executable, "-m", "pytest", "-x", "-q", "--tb=line", "-rfE", "-p", "no:cacheprovider", *tests]
    try:
        done = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return None, ""
    return done.returncode, done.stdout + done.stderr


def judge(mutation: Mutation, code, output: str, seconds: float) -> Outcome:
    """What a run of the tests says of a mutant."""
    found = _ASSERTION.search(output)
    if code == 1 and found:
        return Outcome(mutation, found[1].removeprefix("tests/"), "", seconds)
    if code == 0:
        return Outcome(mutation, "", "survives", seconds)
    wrong = _WRONG.search(output)
    words = "took too long" if code is None else wrong[0] if wrong else output.strip()[-200:]
    return Outcome(mutation, "", f"no assertion failed: {words}", seconds)


def attempt(mutation: Mutation, root: Path) -> Outcome:
    """Apply a mutation to a copy, run its tests, and take it back."""
    begun, path = time.monotonic(), root / mutation.file
    whole = path.read_bytes()
    try:
        mutation.apply(root)
        return judge(mutation, *run_tests(root, mutation.tests), time.monotonic() - begun)
    except ValueError as error:
        return Outcome(mutation, "", str(error), time.monotonic() - begun)
    finally:
        path.write_bytes(whole)


def unmutated(tests, roots) -> str:
    """What is wrong with the tests on the tree as it is, "" where all pass; shared out among copies."""
    shares = [sorted(tests)[i :: len(roots)] for i in range(len(roots))]
    with ThreadPoolExecutor(len(roots)) as pool:
        outcomes = list(pool.map(lambda root, tests: run_tests(root, tests, LIMIT_OF_ALL) if tests else (0, ""),
                                 roots, shares))
    bad = [output for code, output in outcomes if code != 0]
    return "\n".join(_WRONG.findall("\n".join(bad)) or bad)


def run(chosen, workers: int, say=print):
    """Outcomes of the mutations, in their order. Raises ValueError where the tests fail on the tree as it is."""
    with tempfile.TemporaryDirectory(prefix="plausible-mutants-") as folder:
        roots = [Path(folder) / str(i) for i in range(workers)]
        for root in roots:
            root.mkdir()
            copy_tree(root)
        wrong = unmutated({test for mutation in chosen for test in mutation.tests}, roots)
        if wrong:
            raise ValueError(f"the tests fail on the tree as it is:\n{wrong}")
        free = Queue()
        for root in roots:
            free.put(root)

        def one(mutation):
            root = free.get()
            try:
                outcome = attempt(mutation, root)
            finally:
                free.put(root)
            say(line(outcome))
            return outcome

        with ThreadPoolExecutor(workers) as pool:
            return list(pool.map(one, chosen))


def line(outcome: Outcome) -> str:
    """An outcome for the terminal."""
    word = f"caught by {outcome.caught}" if outcome.caught else f"NOT CAUGHT: {outcome.words}"
    return f"{outcome.mutation.name:34} {outcome.seconds:6.1f} s  {word}"


def page(outcomes) -> str:
    """The table as a page of the manual."""
    caught = sum(bool(outcome.caught) for outcome in outcomes)
    rows = "\n".join(f"| {o.mutation.name} | `{o.mutation.file}` | {f'`{o.caught}`' if o.caught else o.words} | "
                     f"{o.seconds:.0f} |" for o in outcomes)
    return (f"# Mutations\n\nWrong factors that were put into a copy of the tree one at a time, by `./run mutate "
            f"--write`, and the test whose\nassertion failed: {caught} of {len(outcomes)} were caught.\n\n"
            f"| mutation | file | caught by | s |\n|---|---|---|---|\n{rows}\n")


def main(argv=None) -> int:
    parser = argparse.ArgumentParser(prog="run mutate", description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="mutations to try (default: all)")
    parser.add_argument("--workers", type=int, default=min(os.cpu_count() or 1, 8), metavar="N",
                        help="how many at once (default: one a core)")
    parser.add_argument("--write", action="store_true", help="write docs/mutations.md")
    parser.add_argument("--list", action="store_true", help="print names and files, and run nothing")
    arguments = parser.parse_args(argv)
    known = {mutation.name: mutation for mutation in MUTATIONS}
    unknown = [name for name in arguments.names if name not in known]
    if unknown or arguments.workers < 1:
        parser.error(f"no mutation {', '.join(unknown)}; --list names them" if unknown else "--workers: at least 1")
    if arguments.write and arguments.names:
        parser.error("--write goes with all mutations: the page holds them all")
    chosen = [known[name] for name in arguments.names] or list(MUTATIONS)
    if arguments.list:
        print("\n".join(f"{mutation.name:34} {mutation.file}" for mutation in chosen))
        return 0
    try:
        outcomes = run(chosen, arguments.workers)
    except ValueError as error:
        print(f"mutate: {error}", file=sys.stderr)
        return 2
    left = [outcome for outcome in outcomes if not outcome.caught]
    print(f"{len(outcomes) - len(left)} of {len(outcomes)} mutations are caught")
    if arguments.write:
        from addon.forms.files import replace_text

        replace_text(ROOT / "docs" / "mutations.md", page(outcomes))
    return 1 if left else 0


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    sys.exit(main())
