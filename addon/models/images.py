"""The luminance of image files.

This package reads uncompressed EXR of four float channels itself. All other files need OpenImageIO, which Blender
bundles from version 4.5 on. It is imported only for such a file.
"""
from pathlib import Path

import numpy as np

from . import exr
from .channels import LUMINANCE
from .errors import ImageError

# Formats of images that store sRGB-encoded values. Float images are linear.
_ENCODED = ("uint8", "uint16")


def stamp(path) -> tuple:
    """(time of the last change in ns, size in bytes) of a file, which change with its contents. () if there is none."""
    try:
        state = Path(path).stat()
    except OSError:
        return ()
    return state.st_mtime_ns, state.st_size


def luminance(path) -> np.ndarray:
    """Linear luminance (height, width) of an image, float64, row 0 at the top.

    Float images contain linear Rec. 709, images of 8 or 16 bits sRGB. Raises ImageError, which names the file and the
    fault.
    """
    path = Path(path)
    if not path.is_file():
        raise ImageError(f"image: {path}: no such file", "missing", path)
    try:
        pixels = exr.read(path)[0].astype(np.float64)
    except OSError as error:
        raise ImageError(f"image: {path} cannot be opened ({error.strerror})", "unreadable", path) from None
    except exr.ExrError:
        pixels = _by_openimageio(path)
    return pixels[..., :3] @ LUMINANCE if pixels.shape[2] >= 3 else pixels[..., 0]


def _by_openimageio(path):
    """Linear pixels (height, width, channels), float64, of any file that OpenImageIO reads."""
    try:
        import OpenImageIO
    except ImportError:
        raise ImageError(f"image: {path}: only EXR of four uncompressed float channels can be read here; the package "
                         "OpenImageIO, which reads others, is missing", "reader", path) from None
    file = OpenImageIO.ImageInput.open(str(path))
    if file is None:
        problem = OpenImageIO.geterror().strip().splitlines()[0]
        raise ImageError(f"image: {path} is not an image ({problem})", "format", path)
    try:
        pixels, kind = file.read_image("float"), str(file.spec().format)
    finally:
        file.close()
    if pixels is None:
        raise ImageError(f"image: {path} is damaged ({file.geterror().strip().splitlines()[0]})", "damaged", path)
    pixels = np.atleast_3d(np.asarray(pixels, dtype=np.float64))
    return _linear(pixels) if kind in _ENCODED else pixels


def _linear(encoded):
    """Linear values of sRGB-encoded ones, both 0..1 (IEC 61966-2-1)."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
