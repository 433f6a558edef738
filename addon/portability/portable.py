"""Tests whether a .blend renders the same alone, with an empty profile, as in its place, and lists what it would lack.

This process loads no Blender: a separate Blender renders each picture by running `probe`.
"""
import contextlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..measure.scene import MeasureError

# The copy's folder: a name as awkward as a user's can be.
_PLACE = "Plausible Übung 旅"
# The reason why packing a .blend leaves such a file out.
_SOCKET = "a path in a shader's text socket, which neither Blender's packing nor an asset tracer (BAT, Flamenco) sees"


@dataclass(frozen=True)
class Finding:
    """A file that a .blend needs, or a setting, in words; `grave` where the picture would differ elsewhere."""

    subject: str
    text: str
    path: str = ""
    exists: bool = False
    grave: bool = True


@dataclass
class Probe:
    """One Blender's pictures of a file, (height, width, 4) `in_place` and `alone`, or an `error` in words.

    `written` names the files that appeared beside the copy.
    """

    blender: str
    version: str = ""
    error: str = ""
    scene: str = ""
    frame: int = 0
    in_place: np.ndarray = None
    alone: np.ndarray = None
    written: list = field(default_factory=list)
    findings: list = field(default_factory=list)

    @property
    def identical(self) -> bool:
        """Whether both pictures are equal, bit for bit."""
        return not self.error and self.in_place.shape == self.alone.shape and \
            self.in_place.tobytes() == self.alone.tobytes()


def travel(blend, blender: str, frame: int | None = None, size: int = 96, samples: int = 8) -> Probe:
    """Renders the file `blend` in its place and alone. `blender` is a Python that has bpy, or a Blender executable.

    `size` is the picture's longer side in pixels, 4..4096, `samples` 1..65536. Raises OSError where the file or the
    program is missing, ValueError for a size or number of samples out of range. A failure in that Blender is in the
    result's `error`.
    """
    blend = Path(blend).resolve()
    if not blend.is_file():
        raise OSError(f"no file {blend}")
    if not 4 <= size <= 4096 or not 1 <= samples <= 1 << 16:
        raise ValueError(f"size {size} and samples {samples} must be from 4 to 4096 and from 1 to {1 << 16}")
    program = shutil.which(blender)
    if program is None:
        raise OSError(f"{blender}: no such program")
    program = os.path.abspath(program)  # links stay: a virtual environment's Python finds it by its own path
    probe = Probe(blender)
    # The first picture is of the file in its place, the second of a copy in another folder.
    picture = {"frame": frame, "size": size, "samples": samples}
    with tempfile.TemporaryDirectory(prefix="plausible-") as folder:
        here, there = Path(folder) / "here", Path(folder) / _PLACE
        here.mkdir()
        result, probe.in_place = _run(program, here, {**picture, "blend": str(blend), "alone": False})
        _record(probe, result)
        if not probe.error:
            with _copied(blend, there, probe.written) as copy:
                result, probe.alone = _run(program, here, {**picture, "blend": str(copy), "alone": True})
            probe.error = f"alone: {result['error']}" if "error" in result else ""
    return probe


def own_blender() -> str:
    """The default Blender: this Python. Raises MeasureError where it has no bpy."""
    import importlib.util

    if importlib.util.find_spec("bpy") is None:
        raise MeasureError("this Python has no bpy: name a Blender, or a Python that has it")
    return sys.executable


@contextlib.contextmanager
def _copied(blend, folder, written):
    """Copies the file to a new read-only folder; on exit, adds the names of new or changed files there to `written`."""
    folder.mkdir()
    copy = folder / blend.name
    shutil.copyfile(blend, copy)
    before = copy.stat().st_mtime_ns
    copy.chmod(0o444)
    folder.chmod(0o555)
    try:
        yield copy
    finally:
        # The administrator can write to a folder that is read-only.
        written += [path.name for path in folder.iterdir() if path != copy or path.stat().st_mtime_ns != before]
        folder.chmod(0o755)
        copy.chmod(0o644)


def _run(blender, folder, job):
    """Has a Blender do a `probe` job; returns its result and its picture, None where there is no picture."""
    for name in ("result.json", "pixels.npy"):
        (folder / name).unlink(missing_ok=True)
    job = {**job, "result": str(folder / "result.json"), "pixels": str(folder / "pixels.npy")}
    (folder / "job.json").write_text(json.dumps(job), encoding="utf-8")
    # The script is alone in its folder, so that Blender's Python finds no module of ours beside it.
    script = folder / "script" / "probe.py"
    script.parent.mkdir(exist_ok=True)
    shutil.copyfile(Path(__file__).with_name("probe.py"), script)
    with tempfile.TemporaryDirectory(prefix="plausible-profile-") as profile:
        command = _command(blender, script, folder / "job.json", job["alone"])
        environment = _environment(job["alone"], profile)
        finished = subprocess.run(command, capture_output=True, text=True, errors="replace", env=environment,
                                  cwd=profile if job["alone"] else None)
    # A Blender that crashes leaves no result, or an earlier one.
    result = {"error": "did not run"}
    if Path(job["result"]).exists():
        result = json.loads(Path(job["result"]).read_text(encoding="utf-8"))
    if finished.returncode or result == {"error": "did not run"}:
        last = (finished.stderr.strip() or finished.stdout.strip() or "nothing").splitlines()[-1].strip()
        result["error"] = f"{result['error']} (exit code {finished.returncode}); it said last: {last}"
    pixels = Path(job["pixels"])
    return result, np.load(pixels) if pixels.exists() else None


def _command(blender, script, job, alone):
    """The command line that runs the script in a Blender, or in a Python that has bpy."""
    version = subprocess.run([blender, "--version"], capture_output=True, text=True, errors="replace")
    if version.stdout.startswith("Python"):
        return [blender, str(script), str(job)]
    return [blender, "--background", *(["--factory-startup"] if alone else []), "--python", str(script), "--", str(job)]


def _environment(alone, profile):
    """The environment of a Blender: the user's, or `alone` without profile, modules and color configuration."""
    environment = dict(os.environ)
    # A bpy loaded in this process has put its own color configuration there, which other versions cannot read.
    if alone or "colormanagement" in environment.get("OCIO", ""):
        environment.pop("OCIO", None)
    if alone:
        for name in list(environment):
            if name == "PYTHONPATH" or name.startswith(("BLENDER_", "CYCLES_", "OSL_")):
                del environment[name]
        environment["BLENDER_USER_RESOURCES"] = profile
    return environment


def _record(probe, result):
    """Records the result of the first picture's job in the probe."""
    probe.error = f"in its place: {result['error']}" if "error" in result else ""
    probe.version = result.get("version", "")
    probe.scene, probe.frame = result.get("scene", ""), result.get("frame", 0)
    if "scripts" in result:
        probe.findings = [*_scripts(result["scripts"]), *_files(result), *_scenes(result)]


def _scripts(scripts):
    """Yields the findings about Script nodes."""
    for script in scripts:
        users = ", ".join(sorted(set(script["users"])))
        if script["external"]:
            yield Finding(users, f"its script is EXTERNAL, {_whereabouts(script)}; choose INTERNAL, which carries its "
                          "bytecode", script["absolute"], script["exists"])
        if script["empty"]:
            yield Finding(users, "its script is INTERNAL and holds no bytecode: Blender crashes or renders black")
        for text in script["texts"]:
            where = f"{text['name']} is {text['path']!r}, {_whereabouts(text)}"
            if text["identifier"].startswith("table_"):
                words = f"{where}: {_SOCKET}; make the material with compiled tables (lut=\"compiled\")"
            elif text["reads"]:
                words = f"{where}: {_SOCKET}"
            else:
                words = f"{where}: not needed to render, as what was baked of it travels; only to bake anew"
            yield Finding(users, words, text["absolute"], text["exists"], text["reads"])


def _files(result):
    """Yields the findings about files outside the .blend, other than scripts."""
    scripts = {script["absolute"] for script in result["scripts"]}
    for file in result["files"]:
        if file["absolute"] not in scripts:
            yield Finding(file["owner"], f"reads {file['path']!r}, {_whereabouts(file)}; pack it into the .blend, or "
                          "send it along", file["absolute"], file["exists"])


def _scenes(result):
    """Yields the findings about the settings of scenes, in a file that has Script nodes."""
    if not result["scripts"]:
        return
    for scene in result["scenes"]:
        subject = f"scene {scene['name']!r}"
        if scene["engine"] != "CYCLES":
            yield Finding(subject, f"renders with {scene['engine']}, which shows stand-ins; it was rendered in Cycles "
                          "here", grave=False)
        elif not scene["osl"]:
            yield Finding(subject, "Open Shading Language is off: materials with a script render black")
        if scene["device"] == "GPU":
            yield Finding(subject, "asks for the GPU, where scripts need OptiX, and these materials more room than "
                          "Cycles has there: set the device to CPU, as it was rendered here")


def _whereabouts(file):
    return "a file outside" if file["exists"] else "which is missing already"


@dataclass(frozen=True)
class Difference:
    """The difference of two pictures: the `largest` of any channel, and the number of `pixels` that differ.

    `mean` is the mean difference of colors, in parts of the first picture's mean color. `coarse` is the same of squares
    of 8 x 8 pixels, where noise counts less. `light` is the ratio of the second picture's sum to the first's.
    """

    largest: float
    pixels: int
    mean: float
    coarse: float
    light: float


def difference(first, second) -> Difference | None:
    """The difference of two pictures (height, width, 4), colors and alpha; None where their shapes differ."""
    if first.shape != second.shape:
        return None
    same = (first == second) | (np.isnan(first) & np.isnan(second))
    first, second = first.astype(np.float64), second.astype(np.float64)
    apart = np.where(same, 0.0, second - first)
    colors = np.abs(first[..., :3]).sum()
    shares = [np.abs(x).sum() / colors if colors else float(not same.all())
              for x in (apart[..., :3], _squares(apart[..., :3]))]
    return Difference(float(np.abs(apart).max()), int((~same).any(axis=-1).sum()), *map(float, shares),
                      float(second[..., :3].sum() / colors) if colors else 1.0)


def _squares(pixels, size=8):
    """Sums over squares of a picture (height, width, channels); squares at its upper and right edge are smaller."""
    for axis in (0, 1):
        pixels = np.add.reduceat(pixels, np.arange(0, pixels.shape[axis], size), axis=axis)
    return pixels
