"""Errors with a sentence for the user and fields for a program.

All are subclasses of ValueError, which every command catches.
"""


class BrdfError(ValueError):
    """The base class of this module's errors. `code` names the kind of fault, or is "" if the class alone does."""

    def __init__(self, message: str, code: str = ""):
        super().__init__(message)
        self.code = code

    def __reduce__(self):
        """Pickling support: the default calls the class with the message alone, which the subclasses do not accept."""
        return _rebuilt, (type(self), self.args, self.__dict__)


def _rebuilt(kind, args, fields):
    """Unpickles an error: restores its fields and its message without a call of __init__."""
    error = kind.__new__(kind, *args)
    error.__dict__.update(fields)
    return error


class UnknownModel(BrdfError):
    """No model has the id `model`. `allowed` are the ids of all models."""

    def __init__(self, model, allowed):
        self.model, self.allowed = model, tuple(allowed)
        super().__init__(f"no model {model!r}; there are {', '.join(self.allowed)}")


class DuplicateModel(BrdfError):
    """The id `model` belongs to a registered model already."""

    def __init__(self, model):
        self.model = model
        super().__init__(f"model {model!r} is registered twice")


class UnknownParameter(BrdfError):
    """The model `model` has no parameter with the id `parameter`. `allowed` are the ids of its parameters."""

    def __init__(self, model, parameter, allowed):
        self.model, self.parameter, self.allowed = model, parameter, tuple(allowed)
        super().__init__(f"{model} has no parameter {parameter!r}; allowed are {', '.join(self.allowed)}")


class ParameterError(BrdfError):
    """`value` is not allowed for `parameter`, an id.

    `code` is one of:
    - "type", "shape": the value is not of the parameter's kind.
    - "range": the value is outside `allowed` = (least, most).
    - "choice": the value is not among the names `allowed`.
    - "path": the value cannot be a file's path.
    """

    def __init__(self, parameter, code, value, problem, allowed=()):
        self.parameter, self.value, self.allowed = parameter, value, tuple(allowed)
        super().__init__(f"{parameter}: {problem}", code)


class ArgumentError(BrdfError):
    """An array argument of a model's method is not valid. `argument` is view, light, u or cos_theta.

    `code` is "type", "shape", "finite", "length" (vectors are not of unit length), "range" or "rows" (two arguments
    have different numbers of rows).
    """

    def __init__(self, argument, code, problem):
        self.argument = argument
        super().__init__(f"{argument}: {problem}", code)


class ImageError(BrdfError):
    """An image cannot be used. `path` is its file, or None if the image is not from a file.

    `code` is "missing", "unreadable", "reader" (the package that reads it is missing), "format" or "damaged". For a
    distribution of half vectors it can also be "square", "size", "pixel" or "black".
    """

    def __init__(self, message, code, path=None):
        self.path = path
        super().__init__(message, code)
