"""The interface between a model and its renderer: a backend reports its abilities and fills a group with its nodes."""
from dataclasses import dataclass, field
from typing import Protocol

# Outputs of a group: for Cycles, and for other engines.
BSDF, STAND_IN = "BSDF", "Stand-in"
# Custom property of a group: the id of its model.
MODEL_KEY = "plausible_model"


class BackendError(RuntimeError):
    """This Blender cannot run a backend. The message gives the reason and a remedy."""


@dataclass(frozen=True)
class Cure:
    """A button that solves a problem: an operator's id, the button's label, and the operator's settings by name."""

    operator: str
    label: str = ""
    settings: dict = field(default_factory=dict, hash=False)


@dataclass(frozen=True)
class Notice:
    """A sentence for the panel, the buttons that solve the reported problem (any one suffices), and an icon."""

    text: str
    cures: tuple = ()
    icon: str = "ERROR"

    def __str__(self):
        return self.text


@dataclass(frozen=True)
class Program:
    """The backend's representation of one model. It is free of bpy and hashable, so that a cache can store it.

    `backend` and `model` are ids. `content` is text in the backend's own format: bytecode for OSL, a node's inputs as
    JSON for the fallback. `spans` are tuples (table, least, largest): the range of exponents of each albedo table that
    is compiled into the program.
    """

    backend: str
    model: str
    content: str
    spans: tuple = ()


class Backend(Protocol):
    """The operations of a backend that the rest of the extension uses. Instances are immutable; options are fields."""

    id: str  # stored on the group
    label: str

    def with_options(self, **options) -> "Backend":
        """This backend with options of `create_material`.

        Raises ValueError for an unknown option and for an invalid value.
        """

    def as_kept(self, group) -> "Backend":
        """This backend with the options stored on a group."""

    def keep_options(self, group):
        """Store the options on a group, for `as_kept`."""

    def why_not(self, scene=None) -> tuple:
        """Notices of the obstacles to rendering, the gravest first; () where there are none.

        Without a scene they cover this Blender alone; with a scene also its device and settings.
        """

    def is_ready(self, scene) -> bool:
        """Whether a scene has the settings that `prepare` switches on."""

    def prepare(self, scene) -> bool:
        """Switch on the settings that the backend needs in a scene. Returns whether a setting changed."""

    def notices(self, node, model, values: dict) -> tuple:
        """Notices about one node of this backend, for `values` by parameter id."""

    def parameters(self, model) -> tuple:
        """The model's parameters that have a socket on a new group of the backend, those of its estimator included.

        A switch from another backend neither adds nor removes sockets.
        """

    def follows_sockets(self, model) -> bool:
        """Whether a program reads the group's sockets. Otherwise it is made for fixed values of the parameters."""

    def can_share(self, model) -> bool:
        """Whether several nodes of a model can share one group."""

    def check(self, model, values: dict):
        """Raise ValueError where the backend cannot render the (resolved) values."""

    def program(self, model, values: dict | None = None, ranges: dict | None = None) -> Program:
        """The program of a model, for `values` by parameter id and `ranges` {id: (least, most)} of driven parameters.

        A value that is missing is the parameter's default. Values from sockets have single precision. Of a driven
        parameter `values` may hold its socket's value: a backend without ranges uses that.

        Raises BackendError where this Blender cannot make the program, ValueError for values that the model rejects.
        """

    def blank(self, model) -> Program:
        """A placeholder program, made at once, of a model whose programs do not follow the sockets."""

    def is_cached(self, model, values: dict, ranges: dict) -> bool:
        """Whether `program` returns at once. Otherwise a thread calls `prefetch` first."""

    def prefetch(self, model, values: dict, ranges: dict, tell):
        """Do the slow part of `program` and keep the result. A thread calls it: bpy is not allowed.

        `tell(done, total)` reports progress; an exception that it raises ends the work.
        """

    def error(self, model, values: dict, ranges: dict) -> tuple | None:
        """Largest errors (of the lobe, of the albedo) of a program up to 80 degrees, as fractions of the albedo.

        None where the backend states no error here. A thread calls it: bpy is not allowed.
        """

    def install(self, group, model, program: Program, inputs: dict):
        """Add the backend's nodes to a group, and link `inputs` {parameter id: socket} to them.

        The group may hold nodes of other backends: find your own by a name or type that no other backend uses, and
        keep the program in a custom property of your own. `inputs` lacks texts, and parameters that
        the group was not made with.

        Returns the nodes' shader socket.
        """

    def update(self, group, program: Program):
        """Replace the program in a group that has the backend's nodes. The links stay."""

    def output(self, group):
        """The shader socket of the backend's nodes in a group; None where the nodes are missing."""

    def installed(self, group) -> Program | None:
        """The program in a group; None where it is missing or damaged."""

    def unfed(self, group, fed_by: dict) -> list:
        """Ids of parameters whose socket on the group no longer feeds the backend's nodes.

        `fed_by` is {parameter id: identifier of the group's socket}.
        """


def refuse_options(backend, options: dict):
    """Raise ValueError where there are options that a backend lacks."""
    if options:
        raise ValueError(f"backend {backend.id!r} has no option {', '.join(options)}")


def text_of(thing, key: str) -> str:
    """A custom property as text; "" where it is missing or has another type, as users may edit it."""
    value = thing.get(key)
    return value if isinstance(value, str) else ""


def pair_of(value):
    """A custom property as a tuple of two numbers; None where it holds something else."""
    numbers = tuple(value) if hasattr(value, "__len__") else ()
    return numbers if len(numbers) == 2 and all(isinstance(n, int | float) for n in numbers) else None


def stored(socket, value):
    """A parameter's value in the form that its socket stores: a color socket has a fourth number, 1."""
    return (*value, 1.0) if isinstance(value, tuple) and len(socket.default_value) == 4 else value
