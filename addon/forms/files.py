"""Writing of whole files: a failure leaves the old file."""
import contextlib
import os


@contextlib.contextmanager
def replacing(path):
    """A temporary path beside `path`. It replaces `path` when the block ends, and is deleted when the block fails."""
    beside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield beside
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


def replace_text(path, text: str):
    """Write `text` to `path` in UTF-8, by a temporary file that is renamed when it is complete."""
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8")
