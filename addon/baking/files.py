"""Writing files whole or not at all."""
import os


def replace_text(path, text: str):
    """Write `text` beside `path` and rename it when it is whole."""
    beside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        beside.write_text(text)
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)
