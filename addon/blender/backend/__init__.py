"""The backends that render a model in Blender, by id. A group stores the id of the backend of its BSDF output."""
from .osl import Osl, OslError
from .principled import PrincipledFit
from .protocol import (
    BSDF,
    MODEL_KEY,
    STAND_IN,
    Backend,
    BackendError,
    Cure,
    Notice,
    Program,
    pair_of,
    stored,
    text_of,
)

# Custom property of a group: the id of its backend. Groups of version 0.2 lack it, and use OSL.
BACKEND_KEY = "plausible_backend"
DEFAULT = Osl()
# Feeds the second output of every group, for other engines.
FALLBACK = PrincipledFit()
BACKENDS = {backend.id: backend for backend in (DEFAULT, FALLBACK)}

__all__ = ["BACKENDS", "BACKEND_KEY", "BSDF", "DEFAULT", "FALLBACK", "MODEL_KEY", "STAND_IN", "Backend", "BackendError",
           "Cure", "Notice", "OslError", "Program", "chosen", "of_group", "pair_of", "stored", "text_of",
           "unknown"]


def chosen(name: str, **options) -> Backend:
    """The backend `name` with its `options`.

    Raises ValueError for an unknown backend, for an unknown option and for an invalid value of one.
    """
    if name not in BACKENDS:
        raise ValueError(f"backend: {name!r} is not one of {', '.join(BACKENDS)}")
    return BACKENDS[name].with_options(**options)


def of_group(group) -> Backend:
    """The backend that feeds a group's BSDF output, with the options stored on the group; see `unknown`."""
    return BACKENDS.get(text_of(group, BACKEND_KEY), DEFAULT).as_kept(group)


def unknown(group) -> str:
    """The id of a group's backend where this version of the extension lacks it, else ""."""
    name = text_of(group, BACKEND_KEY)
    return "" if name in BACKENDS else name
