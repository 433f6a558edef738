"""The cache of what is baked for a material's values: in memory, and on disk where Blender grants us a folder.

A folder is granted to an extension only. Imported by itself, as by a script, the package keeps things in memory, and
writes nothing.
"""
import hashlib
from functools import lru_cache

import bpy

from ...resources import LUTS, OSL, PACKAGE
from . import settings, store

# What decides how values become bytecode: folders of code, and files.
_CODE = [PACKAGE / "models", PACKAGE / "forms", PACKAGE / "backends" / "osl", OSL]
_FILES = [PACKAGE / "blender" / "backend" / "osl.py", LUTS / "ndf_star.exr"]
_IN_MEMORY = 32
_memory = {}  # key -> value, the least recently used first


def fetch(key: str, make):
    """The value kept for `key`, or that of `make()`, which is then kept. Values are such as JSON knows."""
    if holds(key):
        _memory[key] = _memory.pop(key)
        return _memory[key]
    value = make()
    kept = _attempt(on_disk)
    if kept:
        _attempt(lambda: kept.save(key, value))
    _remember(key, value)
    return value


def holds(key: str) -> bool:
    """Whether `fetch` has a value for `key`, from now on in memory."""
    if key not in _memory:
        kept = _attempt(on_disk)
        value = _attempt(lambda: kept.load(key)) if kept else None
        if value is not None:
            _remember(key, value)
    return key in _memory


def _remember(key, value):
    _memory[key] = value
    while len(_memory) > _IN_MEMORY:
        del _memory[next(iter(_memory))]


def _attempt(action):
    """The action's result; a folder that cannot be read or written costs time, and nothing else."""
    try:
        return action()
    except OSError as error:
        print(f"Plausible BRDF: the cache is not used: {error}")
        return None


def key(model, parameters: dict, what: str, driven: dict | None = None) -> str:
    """The key of `what` is baked of a model for its parameters: it changes with all that decides the outcome.

    Of parameters that are `driven`, {id: (least, most)}, the values do not.
    """
    p, driven = model.resolve(parameters), driven or {}
    used = [(q.id, tuple(map(float, driven[q.id])) if q.id in driven else (q.single(p[q.id]), q.stamp(p[q.id])))
            for q in model.parameters if q.evaluated]
    text = repr((what, model.id, used, bpy.app.version[:2], _version()))
    return hashlib.sha256(text.encode()).hexdigest()


@lru_cache(maxsize=1)
def _version() -> str:
    """A hash of the code that bakes, and of the files that it reads."""
    paths = [path for folder in _CODE for path in sorted(folder.rglob("*"))
             if path.suffix in (".py", ".osl", ".h")]
    digest = hashlib.sha256()
    for path in [*paths, *_FILES]:
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def on_disk():
    """The store on disk, or None where Blender grants no folder or the limit is 0."""
    limit = settings.cache_limit()
    folder = settings.granted_folder("cache", create=limit > 0)
    return store.Store(folder, limit) if folder and limit else None


def trim():
    """Hold the cache to its limit, which has just been changed."""
    kept = on_disk()
    if kept is None:
        clear()
    else:
        _attempt(kept.trim)


def size() -> int:
    """Bytes of the cache on disk."""
    folder = settings.granted_folder("cache")
    return store.Store(folder, 0).size() if folder else 0


def clear():
    """Forget everything. Raises OSError where a file cannot be deleted."""
    _memory.clear()
    folder = settings.granted_folder("cache")
    if folder:
        store.Store(folder, 0).clear()


def stop():
    """Forget what is in memory; what is on disk stays for the next time."""
    _memory.clear()
    _version.cache_clear()
