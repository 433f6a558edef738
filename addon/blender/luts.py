"""Albedo tables inside Blender: their folder, what is wrong with them, and baking them in the background."""
import os
import shutil
import threading
from pathlib import Path

import bpy

from ..baking import bake
from ..brdf import tables

# "bl_ext.<repository>.plausible_brdf" inside Blender; "addon" where the package is imported by itself.
ROOT_PACKAGE = __package__.rsplit(".", 2)[0]

job = None  # the bake that runs, or the last one since Blender started
_problems = {}


def user_folder(create=False):
    """The folder for tables that Blender grants this extension, as a Path; None outside of Blender's extensions."""
    if not ROOT_PACKAGE.startswith("bl_ext."):
        return None
    return Path(bpy.utils.extension_path_user(ROOT_PACKAGE, path="luts", create=create))


def start():
    """Use the user's own tables where they are whole and of this version, else the packaged ones."""
    folder = user_folder()
    tables.use_folder(folder)
    if folder is None:
        return
    try:
        for table in tables.TABLES.values():
            tables.load(table)
    except tables.TableError:
        tables.use_folder()


def use_writable_folder():
    """Make sure that the tables in use can be replaced.

    Where their folder is read-only (an extension installed for all users) they are copied to the user's own: until the
    first bake is complete, and after one that is cancelled, every table is still there. Raises OSError.
    """
    source = tables.folder()
    target = user_folder(create=True)
    if target is None or os.access(source, os.W_OK):
        return
    for table in tables.TABLES.values():
        copy = target / table.path.name
        if table.path.exists() and not copy.exists():
            shutil.copyfile(table.path, copy)
    tables.use_folder(target)


def problem(names):
    """What is wrong with the first unusable table of `names`, in words; None when all can be read.

    Panels ask this at every redraw, so an answer is kept until a file changes.
    """
    for name in names:
        table = tables.TABLES[name]
        try:
            state = table.path.stat()
            key = (table.path, state.st_mtime_ns, state.st_size)
        except OSError:
            key = (table.path, None, None)
        if key not in _problems:
            try:
                tables.load(table)
                _problems[key] = None
            except tables.TableError as error:
                _problems[key] = str(error)
        if _problems[key]:
            return _problems[key]
    return None


class BakeJob:
    """A bake in a thread of its own, so that Blender stays responsive; the thread never touches bpy.

    More processes would be faster, but inside Blender each of them would be another Blender.
    `done` and `total` count rows, `table` is the one in work, `error` what ended the bake early.
    """

    def __init__(self, names=None):
        self.names = list(names or tables.TABLES)
        self.done, self.total, self.table = 0, 1, self.names[0]
        self.error, self.cancelled = None, False
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="Plausible BRDF bake", daemon=True)

    def start(self):
        """Begin. Raises OSError when no folder for the tables can be written."""
        use_writable_folder()
        self._thread.start()

    def cancel(self):
        """Ask to end after the row in work; tables that are not complete keep their old files."""
        self._stop.set()

    def wait(self):
        """Return when the thread has ended."""
        if self._thread.ident is not None:
            self._thread.join()

    @property
    def running(self):
        return self._thread.is_alive()

    @property
    def cancelling(self):
        return self._stop.is_set()

    @property
    def share(self):
        """Part done, 0..1."""
        return self.done / self.total

    def _run(self):
        rows = bake.bake(self.names, workers=1)
        try:
            for self.done, self.total, self.table in rows:  # noqa: B020
                if self._stop.is_set():
                    self.cancelled = self.done < self.total
                    break
        except Exception as error:  # a thread has no caller: the operator reports it
            self.error = error
        finally:
            rows.close()
            tables.forget()


def stop():
    """End the bake that runs, wait for it, and go back to the packaged tables."""
    global job
    if job is not None:
        job.cancel()
        job.wait()
        job = None
    _problems.clear()
    tables.use_folder()
