"""The seam between a model and what renders it: each backend says what it can do and fills a group with its nodes."""
from dataclasses import dataclass, field
from typing import Protocol

BSDF, STAND_IN = "BSDF", "Stand-in"  # a group's outputs: for Cycles, and for other engines
MODEL_KEY = "plausible_model"  # of a group: the id of its model


class BackendError(RuntimeError):
    """This Blender cannot run a backend; the message says why and what to do."""


@dataclass(frozen=True)
class Cure:
    """A button: an operator's name, its label, and the operator's settings."""

    operator: str
    label: str = ""
    settings: dict = field(default_factory=dict, hash=False)


@dataclass(frozen=True)
class Notice:
    """A sentence for the panel, the buttons that mend what it reports (any one of them does), and an icon."""

    text: str
    cures: tuple = ()
    icon: str = "ERROR"

    def __str__(self):
        return self.text


@dataclass(frozen=True)
class Program:
    """What a backend renders a model by. It knows no bpy and can be hashed, so a cache can hold it.

    `content` is the backend's own text: bytecode for OSL, a node's inputs as JSON for the fallback. `spans` are
    (table, least, largest): the exponents that the albedo tables inside are baked for.
    """

    backend: str
    model: str
    content: str
    spans: tuple = ()


class Backend(Protocol):
    """What the rest of the extension asks of a backend. Instances are immutable; options are fields."""

    id: str  # kept on the group
    label: str

    def with_options(self, **options) -> "Backend":
        """This backend with options of `create_material`. Raises ValueError for an option that it lacks."""

    def as_kept(self, group) -> "Backend":
        """This backend with the options that a group keeps."""

    def keep_options(self, group):
        """Keep the options on a group, for `as_kept`."""

    def why_not(self, scene=None) -> tuple:
        """Notices of what stands in the way, the gravest first; () where it renders.

        Without a scene they are those of this Blender alone, else also of the scene's device and settings.
        """

    def prepare(self, scene) -> bool:
        """Switch on what the backend needs in a scene; whether that changed anything."""

    def notices(self, node, model, values: dict) -> tuple:
        """Notices about one node that this backend renders."""

    def parameters(self, model) -> tuple:
        """The model's parameters that the backend's groups have sockets for: its estimator's own are among them."""

    def follows_sockets(self, model) -> bool:
        """Whether a program follows the group's sockets. Otherwise it is made for the values of the parameters."""

    def can_share(self, model) -> bool:
        """Whether the nodes of a model can share a group."""

    def check(self, model, values: dict):
        """Raise ValueError where the backend cannot render these (resolved) values."""

    def program(self, model, values: dict | None = None, ranges: dict | None = None) -> Program:
        """The program of a model: for `values` by parameter id, and over `ranges` {id: (least, most)} of driven ones.

        Raises BackendError where this Blender cannot make it, ValueError for values that the model refuses.
        """

    def blank(self, model) -> Program:
        """A program for no values, made at once, of a model whose programs do not follow the sockets."""

    def is_cached(self, model, values: dict, ranges: dict) -> bool:
        """Whether `program` takes no time."""

    def install(self, group, model, program: Program, inputs: dict):
        """Add the backend's nodes to a group, fed by `inputs` {parameter id: socket}; returns their shader socket."""

    def update(self, group, program: Program):
        """Put another program into a group that has the backend's nodes; its links stay."""

    def output(self, group):
        """The shader socket of the backend's nodes in a group; None where they are gone."""

    def installed(self, group) -> Program | None:
        """The program in a group; None where there is none, or none that renders."""

    def unfed(self, group, fed_by: dict) -> list:
        """Ids of parameters whose socket on the group no longer feeds the backend's nodes.

        `fed_by` are {parameter id: identifier of the group's socket}.
        """


def text_of(thing, key: str) -> str:
    """A custom property as text, "" where there is none: users may write there what they like."""
    value = thing.get(key)
    return value if isinstance(value, str) else ""


def pair_of(value):
    """Two numbers out of a custom property; None where it holds something else."""
    numbers = tuple(value) if hasattr(value, "__len__") else ()
    return numbers if len(numbers) == 2 and all(isinstance(n, int | float) for n in numbers) else None


def stored(socket, value):
    """A parameter's value as its socket stores it: colors have a fourth number."""
    return (*value, 1.0) if isinstance(value, tuple) and len(socket.default_value) == 4 else value
