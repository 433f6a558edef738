"""`pip install .` in a fresh environment: the reference in NumPy and the command work, with tables and shaders."""
import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
# What an installation is made of, in a copy: a build leaves folders behind.
SOURCES = ("addon", "osl", "luts", "blender_manifest.toml", "pyproject.toml", "setup.py", "README.md", "LICENSE")
REFERENCE = """
import json
import numpy as np
from addon import assets, brdf, resources, version
from addon.backends.osl import assembler
from addon.forms.albedo.tabulated import TABULATED
model, up = brdf.MODELS["pumped_phong"], np.array([[0.0, 0.0, 1.0]])
given = {"exponent": 20.0, "pumps": 2.0, "control": False}
print(json.dumps({
    "integrated": model.evaluate(up, up, **given)[0],
    "tabulated": model.with_albedos(TABULATED).evaluate(up, up, **given)[0],
    "shaders": [len(assembler.assemble(brdf.MODELS[name])) for name in ("pumped_phong", "disk_scaling", "ward")],
    "version": version.VERSION, "inside": resources.LUTS.is_relative_to(resources.PACKAGE),
    "assets": assets.LIBRARY.is_file() and assets.preview("ward").is_file()}))
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """The folder of commands of an environment that has this package and what it asks for, and nothing else."""
    folder = tmp_path_factory.mktemp("fresh")
    source = folder / "source"
    source.mkdir()
    for name in SOURCES:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / name, source)
    run(sys.executable, "-m", "venv", folder / "environment")
    commands = folder / "environment" / ("Scripts" if sys.platform == "win32" else "bin")
    run(commands / "python", "-m", "pip", "install", "-q", "--disable-pip-version-check", source)
    return commands


def run(*command, cwd=None):
    done = subprocess.run([str(part) for part in command], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_reference_has_its_tables_and_shaders(installed, tmp_path):
    found = json.loads(run(installed / "python", "-c", REFERENCE, cwd=tmp_path))
    assert found["integrated"] == pytest.approx(found["tabulated"], rel=2e-5)
    # (n+2)/(2 pi) over m_0 m_1, the paper's albedos at normal incidence being 1 to this precision.
    assert found["integrated"] == pytest.approx(22.0 / 6.283185307, rel=0.02)
    assert min(found["shaders"]) > 10_000 and found["inside"] and found["assets"]
    assert f'version = "{found["version"]}"' in (ROOT / "blender_manifest.toml").read_text(encoding="utf-8")


def test_the_command_works(installed, tmp_path):
    assert json.loads(run(installed / "plausible", "list", "pumped_phong", "--json", cwd=tmp_path))[0]["tables"] == [
        "phong_plain", "phong_controlled"]
    assert "half-angle" in run(installed / "plausible", "match", "--from", "phong", "--to", "blinn", cwd=tmp_path)


@pytest.mark.parametrize("name", ["build", "docs", "previews", "assets"])
def test_what_writes_into_a_checkout_is_refused(installed, tmp_path, name):
    done = subprocess.run([str(installed / "plausible"), name], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2 and "checkout" in done.stderr and done.stderr.count("\n") == 1, done.stderr
