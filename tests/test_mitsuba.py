"""Another renderer judges: Mitsuba's chi-square test of the samplers, and the same scenes in it and in Cycles.

Mitsuba runs in a process of its own, see mitsuba_judge.py; in an environment where it is installed, or by the
interpreter that PLAUSIBLE_MITSUBA_PYTHON names.
"""
import importlib.util
import json
import os
import subprocess
import sys
import zlib
from pathlib import Path

import pytest

from addon.brdf import MODELS
from addon.brdf.geometry import in_plane

PYTHON = os.environ.get("PLAUSIBLE_MITSUBA_PYTHON") or sys.executable
JUDGE = Path(__file__).with_name("mitsuba_judge.py")
pytestmark = [pytest.mark.proof, pytest.mark.skipif(
    sys.executable == PYTHON and importlib.util.find_spec("mitsuba") is None,
    reason="Mitsuba is not installed: pip install mitsuba, for Python 3.13")]


def judged(what, jobs, folder):
    """What Mitsuba says of `jobs`, see mitsuba_judge.py."""
    path = folder / "jobs.json"
    path.write_text(json.dumps(jobs), encoding="utf-8")
    result = subprocess.run([PYTHON, str(JUDGE), what, str(path)], capture_output=True, text=True, cwd=folder)
    assert result.returncode == 0, result.stderr[-3000:]
    return json.loads(result.stdout)


# The chi-square test, one configuration of each family: of lobes a few of its cells wide and without steps, for it adds
# up densities by the trapezium rule inside even cells.

CHI_SQUARE = [
    ("phong", 60.0, {}), ("pumped_blinn", 40.0, {"exponent": 50.0}), ("phong_limit", 85.0, {"exponent": 5.0}),
    ("disk_scaling", 50.0, {"radius_u": 0.3, "radius_v": 0.7, "rotation": 0.1}),
    ("disk_orthogonal", 30.0, {"radius_u": 0.5}), ("edwards_empirical", 50.0, {"retro": 0.4, "base_color": 0.5}),
    ("edwards_fit", 45.0, {}), ("reciprocal_disk", 60.0, {"exponent": 4.0}),
    ("ward", 45.0, {"roughness_u": 0.2, "roughness_v": 0.5, "diffuse_color": 0.3}), ("ward_bounded", 30.0, {}),
    ("cook_torrance", 40.0, {}), ("he_torrance", 30.0, {}), ("embrechts", 60.0, {}),
    ("ashikhmin_shirley", 45.0, {"exponent_u": 100.0, "exponent_v": 10.0, "base_color": 0.4, "diffuse_color": 0.5}),
    ("lafortune", 50.0, {}), ("weighted_lobes", 30.0, {}), ("kajiya_kay", 70.0, {}),
    ("pumped_ward", 20.0, {"roughness_u": 0.4}),
]
PLANTED = [("phong", 60.0, {}, {"exponent": 20.6}), ("pumped_blinn", 40.0, {"exponent": 50.0}, {"exponent": 51.5}),
           ("disk_scaling", 50.0, {"rotation": 0.1, "radius_u": 0.5}, {"rotation": 0.11, "radius_u": 0.5}),
           ("ward", 45.0, {}, {"roughness_u": 0.155}),
           ("lafortune", 50.0, {}, {"weight_2": 0.12})]


def chi_square_jobs():
    right = [{"model": model, "parameters": parameters, "view": in_plane([angle])[0].tolist()}
             for model, angle, parameters in CHI_SQUARE]
    wrong = [{"model": model, "parameters": parameters, "claimed": claimed, "view": in_plane([angle])[0].tolist()}
             for model, angle, parameters, claimed in PLANTED]
    for job in (*right, *wrong):
        job["name"] = f"{job['model']} {job['parameters']}" + (" claimed" if "claimed" in job else "")
        job.update(tests=len(CHI_SQUARE), seed=zlib.crc32(job["name"].encode()) % 2**31)
    return right, wrong


def test_mitsubas_chi_square_test_accepts_the_samplers_and_rejects_what_is_planted(tmp_path):
    right, wrong = chi_square_jobs()
    assert {job["model"] for job in right} <= set(MODELS) and len(right) >= 15
    verdicts = judged("chi2", right + wrong, tmp_path)
    refused = [v for v in verdicts[:len(right)] if not v["passes"]]
    assert refused == [], "\n".join(f"{v['name']}: {v['messages']}" for v in refused)
    assert [v["name"] for v in verdicts[len(right):] if v["passes"]] == []
