"""What was baked of a model is kept on disk, for all processes of a run of the tests, and for more runs where asked.

A bake takes 2 to 20 seconds, and many tests need the same ones. An entry is for the code that bakes, the interpreter,
NumPy and SciPy, and the parameters: with any of them changed, as in a mutant, there is none. A test that replaces
something by `monkeypatch` bakes anew, unless it is marked `keeps_bakes`: what it replaces has no part in bakes.

PLAUSIBLE_BAKES names the folder; without it each run has its own.
"""
import hashlib
import pickle
import platform
from functools import lru_cache, wraps
from pathlib import Path

import numpy
import scipy

from addon.brdf import MODELS

ROOT = Path(__file__).resolve().parents[1]
CODE = ("addon/models", "addon/forms", "luts")
_state = {"folder": None, "allowed": False}


@lru_cache(maxsize=1)
def _version() -> str:
    """A hash of all that decides what a bake of given parameters is."""
    digest = hashlib.sha256(repr((platform.python_version(), numpy.__version__, scipy.__version__)).encode())
    for path in sorted(path for folder in CODE for path in (ROOT / folder).rglob("*") if path.suffix != ".pyc"):
        if path.is_file():
            digest.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def use(folder):
    """Keep entries in `folder`."""
    _state["folder"] = Path(folder)
    _state["folder"].mkdir(parents=True, exist_ok=True)


def allow(whether: bool):
    """Whether entries are read and written from now on."""
    _state["allowed"] = whether


def keep(module, name: str):
    """Let `module.name(model, *arguments)`, which keeps its last results in memory, keep all of them on disk."""
    remembering = getattr(module, name)
    make = remembering.__wrapped__

    @lru_cache(**remembering.cache_parameters())
    @wraps(make)
    def kept(model, *arguments):
        if not _state["allowed"] or MODELS.get(model.id) is not model:
            return make(model, *arguments)
        key = hashlib.sha256(repr((_version(), name, model.id, arguments)).encode()).hexdigest()
        path = _state["folder"] / key
        if not path.is_file():
            value = make(model, *arguments)
            beside = path.with_suffix(f".{id(value):x}")
            beside.write_bytes(pickle.dumps(value))
            beside.replace(path)
            return value
        return pickle.loads(path.read_bytes())

    setattr(module, name, kept)
