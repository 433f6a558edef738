"""Readable names of parametrized cases."""


def name_of(value):
    return str(value) if not isinstance(value, dict) else " ".join(f"{k}={v}" for k, v in value.items()) or "default"
