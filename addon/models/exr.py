"""Float32 RGBA OpenEXR images of uncompressed scanlines, read and written by NumPy alone.

Albedo tables need no more. Blender 4.2 bundles no OpenImageIO for Python, and tables are read and baked there, too. The
tests compare this module with OpenImageIO in both directions. Format: "OpenEXR File Layout", openexr.com.
"""
import struct
from pathlib import Path

import numpy as np

from .errors import BrdfError

# The file's first four bytes, the format's version, and the code of float channels.
_MAGIC, _VERSION, _FLOAT = 20000630, 2, 2
# A scanline stores its channels in alphabetical order.
_CHANNELS = "ABGR"


class ExrError(BrdfError):
    """The file is damaged, or is not of the kind that this module writes.

    `code` is "header", "format" (another kind of EXR, or no EXR) or "truncated".
    """


def _attribute(name, kind, payload):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(payload)) + payload


def encode(pixels: np.ndarray, metadata: dict) -> bytes:
    """The bytes of an EXR file with `pixels` (height, width, 4) in RGBA order and `metadata` as string attributes."""
    # The header: its attributes, and the table of the scanlines' offsets.
    height, width = pixels.shape[:2]
    channels = b"".join(c.encode() + b"\0" + struct.pack("<iB3xii", _FLOAT, 0, 1, 1) for c in _CHANNELS) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = struct.pack("<ii", _MAGIC, _VERSION) + b"".join(
        [
            _attribute("channels", "chlist", channels),
            _attribute("compression", "compression", b"\0"),
            _attribute("dataWindow", "box2i", window),
            _attribute("displayWindow", "box2i", window),
            _attribute("lineOrder", "lineOrder", b"\0"),
            _attribute("pixelAspectRatio", "float", struct.pack("<f", 1.0)),
            _attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0.0, 0.0)),
            _attribute("screenWindowWidth", "float", struct.pack("<f", 1.0)),
        ]
        + [_attribute(key, "string", str(value).encode()) for key, value in metadata.items()]
        + [b"\0"]
    )
    # The offsets and the scanlines, channel by channel.
    line_bytes = width * 4 * len(_CHANNELS)
    first = len(header) + 8 * height
    offsets = np.arange(height, dtype="<u8") * (8 + line_bytes) + first
    lines = np.ascontiguousarray(pixels[:, :, ::-1].transpose(0, 2, 1), dtype="<f4")
    body = b"".join(struct.pack("<ii", y, line_bytes) + lines[y].tobytes() for y in range(height))
    return header + offsets.tobytes() + body


def decode(data: bytes):
    """Returns (pixels (height, width, 4) float32 in RGBA order, metadata {name: text}). Raises ExrError."""
    try:
        return _decode(data)
    except ExrError:
        raise
    except (struct.error, IndexError, KeyError, ValueError) as error:
        raise ExrError(f"truncated or damaged header ({error})", "header") from None


def _decode(data):
    if struct.unpack_from("<ii", data) != (_MAGIC, _VERSION):
        raise ExrError("not an uncompressed scanline EXR image", "format")
    # {name: (type, bytes)}, by null-terminated names and types and the size of each value.
    at, attributes = 8, {}
    while data[at] != 0:
        name_end = data.index(b"\0", at)
        kind_end = data.index(b"\0", name_end + 1)
        (size,) = struct.unpack_from("<i", data, kind_end + 1)
        start = kind_end + 5
        if size < 0 or start + size > len(data):
            raise ExrError("truncated header", "header")
        attributes[data[at:name_end].decode()] = (data[name_end + 1 : kind_end].decode(), data[start : start + size])
        at = start + size
    # The kind of image and its size.
    channels = attributes["channels"][1]
    if channels.count(b"\0\2\0\0\0") != 4 or attributes["compression"][1] != b"\0":
        raise ExrError("expected four uncompressed float channels R, G, B, A", "format")
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"][1])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    block = 8 + width * 16
    body = at + 1 + 8 * height
    if not (0 < width <= 16384 and 0 < height <= 16384) or len(data) != body + height * block:
        needed = body + height * block
        raise ExrError(f"truncated or resized: {len(data)} bytes where {width} x {height} pixels need {needed}",
                       "truncated")
    # Each scanline has 8 bytes of its own header before its channels.
    lines = np.frombuffer(data, np.uint8, offset=body).reshape(height, block)[:, 8:]
    pixels = np.ascontiguousarray(lines).view("<f4").reshape(height, 4, width).transpose(0, 2, 1)[:, :, ::-1]
    metadata = {key: value.decode() for key, (kind, value) in attributes.items() if kind == "string"}
    return np.array(pixels), metadata


def write(path: Path, pixels: np.ndarray, metadata: dict):
    """Writes an EXR file under another name, then renames it to `path`. An existing file stays whole until then."""
    path = Path(path)
    beside = path.with_name(f".{path.name}.{id(pixels):x}.part")
    try:
        beside.write_bytes(encode(pixels, metadata))
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


def read(path: Path):
    """Reads a file that `write` wrote, see `decode`. Raises ExrError, which names the file, and OSError."""
    try:
        return decode(Path(path).read_bytes())
    except ExrError as error:
        raise ExrError(f"{path}: {error}", error.code) from None
