"""Packs the files that lie beside the package into its folder `data`: see addon/resources.py."""
import shutil
import tomllib
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parent
DATA = ("luts", "osl", "blender_manifest.toml")


class BuildWithData(build_py):
    """Builds the package with the files beside it. An editable installation finds them where they lie."""

    def run(self):
        super().run()
        if self.editable_mode:
            return
        target = Path(self.build_lib) / "addon" / "data"
        for name in DATA:
            source = ROOT / name
            if source.is_dir():
                shutil.copytree(source, target / name, dirs_exist_ok=True)
            else:
                target.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, target / name)


MANIFEST = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
setup(version=MANIFEST["version"], cmdclass={"build_py": BuildWithData})
