"""Readable ids of parametrized tests."""


def name_of(value):
    """The id of a value: "key=value ..." for a dict, "default" for an empty one."""
    return str(value) if not isinstance(value, dict) else " ".join(f"{k}={v}" for k, v in value.items()) or "default"
