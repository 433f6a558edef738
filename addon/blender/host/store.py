"""What took long to compute, kept in a folder: few files, compressed, each whole or not there at all.

Entries are values that JSON knows, by a key of hexadecimal digits. Those that were not used for longest are dropped
when there are more bytes than allowed.
"""
import json
import os
import time
import zlib
from pathlib import Path

from ...forms.files import replacing

_SUFFIX = ".z"
_ABANDONED = 3600.0  # seconds after which a part of an entry was left behind by a process that was killed


class Store:
    """Entries in `folder`, up to `limit` bytes in all. The folder is there; several processes may share it."""

    def __init__(self, folder, limit: int):
        self.folder, self.limit = Path(folder), limit

    def load(self, key: str):
        """The value kept for a key, used now; None where there is none. A damaged entry is deleted."""
        path = self._path(key)
        try:
            data = path.read_bytes()
        except FileNotFoundError:
            return None
        try:
            value = json.loads(zlib.decompress(data))
        except (zlib.error, ValueError):
            path.unlink(missing_ok=True)
            return None
        os.utime(path)
        return value

    def save(self, key: str, value):
        """Keep a value, and drop what was not used for longest. Raises OSError where that cannot be written."""
        data = zlib.compress(json.dumps(value).encode(), 6)
        if len(data) > self.limit:
            return
        with replacing(self._path(key)) as beside:
            beside.write_bytes(data)
        self.trim()

    def trim(self):
        """Drop entries, those first that were not used for longest, until the rest is within the limit."""
        entries = sorted(self._entries(), key=lambda entry: entry[1].st_mtime_ns)
        total = sum(state.st_size for _, state in entries)
        for path, state in entries:
            if total <= self.limit:
                break
            path.unlink(missing_ok=True)
            total -= state.st_size
        for part in self.folder.glob(f".*{_SUFFIX}.*.part"):
            if time.time() - part.stat().st_mtime > _ABANDONED:
                part.unlink(missing_ok=True)

    def size(self) -> int:
        """Bytes of all entries."""
        return sum(state.st_size for _, state in self._entries())

    def clear(self):
        """Delete all entries. Raises OSError where that is not allowed."""
        for path, _ in self._entries():
            path.unlink(missing_ok=True)

    def _path(self, key):
        return self.folder / f"{key}{_SUFFIX}"

    def _entries(self):
        """[(path, its state)]; what another process deletes meanwhile is left out."""
        found = []
        for path in self.folder.glob(f"*{_SUFFIX}"):
            try:
                found.append((path, path.stat()))
            except FileNotFoundError:
                continue
        return found
