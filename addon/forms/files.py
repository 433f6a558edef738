"""Writing files whole or not at all."""
import contextlib
import os


@contextlib.contextmanager
def replacing(path):
    """A path beside `path` to write to, which takes its place when the block ends, and goes where that fails."""
    beside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield beside
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


def replace_text(path, text: str):
    """Write `text` beside `path`, in UTF-8, and rename it when it is whole."""
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8")
