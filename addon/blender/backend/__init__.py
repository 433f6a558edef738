"""What can render a model in Blender, by id. A group keeps the id of the backend that feeds its BSDF output."""
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

BACKEND_KEY = "plausible_backend"  # of a group; groups of version 0.2 have none, and are OSL's
DEFAULT = Osl()
FALLBACK = PrincipledFit()  # feeds the second output of every group, for other engines
BACKENDS = {backend.id: backend for backend in (DEFAULT, FALLBACK)}

__all__ = ["BACKENDS", "BACKEND_KEY", "BSDF", "DEFAULT", "FALLBACK", "MODEL_KEY", "STAND_IN", "Backend", "BackendError",
           "Cure", "Notice", "OslError", "Program", "chosen", "of_group", "pair_of", "stored", "text_of"]


def chosen(name: str, **options) -> Backend:
    """The backend `name` with its `options`. Raises ValueError for an unknown backend or option."""
    if name not in BACKENDS:
        raise ValueError(f"backend: {name!r} is not one of {', '.join(BACKENDS)}")
    return BACKENDS[name].with_options(**options)


def of_group(group) -> Backend:
    """The backend that feeds a group's BSDF output, with the options that the group keeps."""
    return BACKENDS.get(text_of(group, BACKEND_KEY), DEFAULT).as_kept(group)
