"""The cache of bytecode with lobe rows, and of the rows' errors: in memory, and on disk in the extension's folder.

Blender provides such a folder for extensions only. Where the package is imported otherwise, as by a script, the cache
is in memory, and nothing is written.
"""
import hashlib
from functools import lru_cache

import bpy

from ...resources import LUTS, OSL, PACKAGE
from . import settings, store

# Folders of code, and files, that determine the bytecode for given values. They are part of every key.
_CODE = [PACKAGE / "models", PACKAGE / "forms", PACKAGE / "backends" / "osl", OSL]
_FILES = [PACKAGE / "blender" / "backend" / "osl.py", LUTS / "ndf_star.exr"]
_IN_MEMORY = 32  # entries
_memory = {}  # key -> value, the least recently used first


def fetch(key: str, make):
    """The cached value for `key`, or the result of `make()`, which is cached then unless it is None.

    Values have to be valid JSON.
    """
    if holds(key):
        # Move the entry to the end: it is the most recently used now.
        _memory[key] = _memory.pop(key)
        return _memory[key]
    value = make()
    if value is None:
        return None
    disk = _attempt(on_disk)
    if disk:
        _attempt(lambda: disk.save(key, value))
    _remember(key, value)
    return value


def holds(key: str) -> bool:
    """Whether the cache has a value for `key`. A value on disk is loaded into memory."""
    if key not in _memory:
        disk = _attempt(on_disk)
        value = _attempt(lambda: disk.load(key)) if disk else None
        if value is not None:
            _remember(key, value)
    return key in _memory


def _remember(key, value):
    """Put a value into memory, and drop the least recently used ones beyond the limit."""
    _memory[key] = value
    while len(_memory) > _IN_MEMORY:
        del _memory[next(iter(_memory))]


def _attempt(action):
    """The result of `action()`; None, with a printed message, where the folder cannot be read or written."""
    try:
        return action()
    except OSError as error:
        print(f"Plausible BRDF: the cache is not used: {error}")
        return None


def key(model, parameters: dict, what: str, driven: dict | None = None) -> str:
    """The key of a bake, as 64 hexadecimal digits: SHA-256 of everything that determines the result.

    `what` names the kind of result ("shader", "error"), `parameters` are the model's, and `driven` is
    {id: (least, most)}. The values of driven parameters do not count, as their ranges do.
    """
    p, driven = model.resolve(parameters), driven or {}
    used = [(q.id, tuple(map(float, driven[q.id])) if q.id in driven else (q.single(p[q.id]), q.stamp(p[q.id])))
            for q in model.parameters if q.evaluated]
    text = repr((what, model.id, used, bpy.app.version[:2], _version()))
    return hashlib.sha256(text.encode()).hexdigest()


@lru_cache(maxsize=1)
def _version() -> str:
    """SHA-256 of the baking code and of the files that it reads."""
    paths = [path for folder in _CODE for path in sorted(folder.rglob("*"))
             if path.suffix in (".py", ".osl", ".h")]
    digest = hashlib.sha256()
    for path in [*paths, *_FILES]:
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def on_disk():
    """The `Store` on disk; None where the package is no extension, or the size limit is 0."""
    limit = settings.cache_limit()
    folder = settings.granted_folder("cache", create=limit > 0)
    return store.Store(folder, limit) if folder and limit else None


def trim():
    """Shrink the cache on disk to its size limit, after a change of the limit."""
    disk = on_disk()
    if disk is None:
        clear()
    else:
        _attempt(disk.trim)


def size() -> int:
    """Size of the cache on disk, in bytes."""
    folder = settings.granted_folder("cache")
    return store.Store(folder, 0).size() if folder else 0


def clear():
    """Empty the cache, in memory and on disk. Raises OSError where a file cannot be deleted."""
    _memory.clear()
    folder = settings.granted_folder("cache")
    if folder:
        store.Store(folder, 0).clear()


def stop():
    """Empty the cache in memory. The cache on disk stays."""
    _memory.clear()
    _version.cache_clear()
