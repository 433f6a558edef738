"""A store of computed values in a folder: one compressed file per entry, written atomically.

Values have to be valid JSON; keys are hexadecimal digits. The least recently used entries are deleted when the total
size exceeds a limit.
"""
import json
import os
import time
import zlib
from pathlib import Path

from ...forms.files import replacing

_SUFFIX = ".z"
# Age in seconds at which an incomplete file counts as left by a killed process.
_ABANDONED = 3600.0


class Store:
    """Entries in `folder`, which has to exist, of at most `limit` bytes in total. Several processes may share it."""

    def __init__(self, folder, limit: int):
        self.folder, self.limit = Path(folder), limit

    def load(self, key: str):
        """The value of a key, marked as just used; None where there is none. A damaged entry is deleted."""
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
        os.utime(path)  # the time of modification stands for the last use
        return value

    def save(self, key: str, value):
        """Store a value, and `trim`. A value above the size limit is not stored.

        Raises OSError where the folder cannot be written.
        """
        data = zlib.compress(json.dumps(value).encode(), 6)
        if len(data) > self.limit:
            return
        with replacing(self._path(key)) as temporary:
            temporary.write_bytes(data)
        self.trim()

    def trim(self):
        """Delete the least recently used entries until the others fit the limit. Deletes abandoned files, too."""
        entries = sorted(self._entries(), key=lambda entry: entry[1].st_mtime_ns)
        total = sum(state.st_size for _, state in entries)
        for path, state in entries:
            if total <= self.limit:
                break
            path.unlink(missing_ok=True)
            total -= state.st_size
        # Incomplete files of killed processes.
        for incomplete in self.folder.glob(f".*{_SUFFIX}.*.part"):
            if time.time() - incomplete.stat().st_mtime > _ABANDONED:
                incomplete.unlink(missing_ok=True)

    def size(self) -> int:
        """Total size of all entries, in bytes."""
        return sum(state.st_size for _, state in self._entries())

    def clear(self):
        """Delete all entries. Raises OSError where a file cannot be deleted."""
        for path, _ in self._entries():
            path.unlink(missing_ok=True)

    def _path(self, key):
        return self.folder / f"{key}{_SUFFIX}"

    def _entries(self):
        """[(path, its os.stat_result)], without files that another process deletes meanwhile."""
        entries = []
        for path in self.folder.glob(f"*{_SUFFIX}"):
            try:
                entries.append((path, path.stat()))
            except FileNotFoundError:
                continue
        return entries
