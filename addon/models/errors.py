"""Errors that say in fields what is wrong, beside the sentence that a user reads.

All are ValueErrors: who catches those, as every command does, catches these.
"""


class BrdfError(ValueError):
    """What was asked cannot be done; `code` names the kind of fault, "" where the class says it all."""

    def __init__(self, message: str, code: str = ""):
        super().__init__(message)
        self.code = code

    def __reduce__(self):
        return _rebuilt, (type(self), self.args, self.__dict__)


def _rebuilt(kind, args, fields):
    """An error that was sent from another process: its fields, without the sentence being made anew."""
    error = kind.__new__(kind, *args)
    error.__dict__.update(fields)
    return error


class UnknownModel(BrdfError):
    """No model is called `model`; `allowed` are the ids of those that there are."""

    def __init__(self, model, allowed):
        self.model, self.allowed = model, tuple(allowed)
        super().__init__(f"no model {model!r}; there are {', '.join(self.allowed)}")


class DuplicateModel(BrdfError):
    """A second model called `model`."""

    def __init__(self, model):
        self.model = model
        super().__init__(f"model {model!r} is registered twice")


class UnknownParameter(BrdfError):
    """The model `model` has no parameter called `parameter`; `allowed` are the ids of those that it has."""

    def __init__(self, model, parameter, allowed):
        self.model, self.parameter, self.allowed = model, parameter, tuple(allowed)
        super().__init__(f"{model} has no parameter {parameter!r}; allowed are {', '.join(self.allowed)}")


class ParameterError(BrdfError):
    """A parameter cannot have a value.

    `code` is "type" or "shape", where `value` is nothing of the parameter's kind; "range", beyond `allowed` = (least,
    most); "choice", none of the texts `allowed`; or "path", of no file.
    """

    def __init__(self, parameter, code, value, problem, allowed=()):
        self.parameter, self.value, self.allowed = parameter, value, tuple(allowed)
        super().__init__(f"{parameter}: {problem}", code)


class ArgumentError(BrdfError):
    """An array that a model is evaluated at is not what it should be: `argument` is view, light, u or cos_theta.

    `code` is "type", "shape", "finite", "length" (of vectors that are no unit vectors), "range" or "rows" (of two
    arguments that do not go together).
    """

    def __init__(self, argument, code, problem):
        self.argument = argument
        super().__init__(f"{argument}: {problem}", code)


class ImageError(BrdfError):
    """An image cannot be used. `path` is its file, None where it is none.

    `code` is "missing", "unreadable", "reader" (a package is missing), "format", "damaged"; and of a distribution of
    half vectors "square", "size", "pixel" or "black".
    """

    def __init__(self, message, code, path=None):
        self.path = path
        super().__init__(message, code)
