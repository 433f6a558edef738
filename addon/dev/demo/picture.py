"""Renders and writes the demos' pictures."""
import contextlib
import os
import sys
import time
from pathlib import Path

import bpy


def prepare(scene, samples: int, exposure: float, indirect_clamp: float, bounces: int = 8):
    """Set the renderer: CPU, OSL, `samples` per pixel at most, no denoising.

    Indirect light brighter than `indirect_clamp` per sample is cut, so that few samples make a clean picture.
    Direct light is whole. `exposure` in stops.
    """
    cycles = scene.cycles
    cycles.device, cycles.shading_system = "CPU", True
    cycles.samples, cycles.seed = samples, 0
    cycles.use_adaptive_sampling, cycles.adaptive_threshold = True, 0.02
    cycles.use_denoising = False
    cycles.max_bounces = cycles.glossy_bounces = bounces
    cycles.caustics_reflective = True
    cycles.blur_glossy = 0.0
    cycles.sample_clamp_direct, cycles.sample_clamp_indirect = 0.0, indirect_clamp
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.exposure = exposure


def write(scene, folder: Path, stem: str, alpha: bool = False) -> Path:
    """Render to `folder`/`stem`.exr (float32, linear Rec. 709) and `stem`.png; returns the PNG's path.

    `alpha` writes the coverage of pixels as well, where the scene's film is transparent.
    """
    settings, channels = scene.render.image_settings, "RGBA" if alpha else "RGB"
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", channels, "32"
    settings.exr_codec = "ZIP"
    scene.render.filepath = str(folder / f"{stem}.exr")
    with quiet():
        bpy.ops.render.render(write_still=True, scene=scene.name)
    image = bpy.data.images.load(scene.render.filepath)
    settings.file_format, settings.color_mode, settings.color_depth = "PNG", channels, "8"
    png = folder / f"{stem}.png"
    image.save_render(str(png), scene=scene)
    bpy.data.images.remove(image)
    return png


def write_all(steps, report=None) -> list:
    """Runs `steps`, pairs (caption, function that renders); returns the paths. `report(line)` gets the progress."""
    paths = []
    for number, (caption, step) in enumerate(steps, 1):
        start = time.monotonic()
        paths.append(step())
        if report:
            report(f"[{number}/{len(steps)}] {caption}: {time.monotonic() - start:.0f} s")
    return paths


@contextlib.contextmanager
def quiet():
    """Discards the renderer's standard output, which is for the command's results."""
    sys.stdout.flush()
    saved, null = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    try:
        yield
    finally:
        os.dup2(saved, 1)
        os.close(saved)
        os.close(null)
