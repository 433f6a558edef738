"""Baking albedo tables in the background."""
import threading
import time

from ...forms.albedo import bake, sizes, tables
from .table_folder import use_bake_folder

job = None  # the bake that runs, or the last one since Blender started


class BakeJob:
    """A bake in a thread of its own, so that Blender stays responsive; the thread never touches bpy.

    More processes would be faster, but inside Blender each of them would be another Blender.
    `done` and `total` count steps, `table` is the one in work, `error` what ended the bake early.
    """

    def __init__(self, names=None, size=sizes.STANDARD):
        self.names, self.size = list(names or tables.TABLES), size
        self.done, self.total, self.table = 0, 1, self.names[0]
        self.error, self.cancelled = None, False
        self._began = self._ended = None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="Plausible BRDF bake", daemon=True)

    def start(self):
        """Begin. Raises OSError when no folder for the tables can be written."""
        use_bake_folder()
        self._began = time.monotonic()
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

    @property
    def seconds(self):
        """How long it has run, or ran."""
        return (self._ended or time.monotonic()) - self._began

    @property
    def seconds_left(self):
        """How long it will go on, should the rest take as long as what is done."""
        return self.seconds * (self.total / max(self.done, 1) - 1.0)

    def _run(self):
        rows = bake.bake(self.names, workers=1, size=self.size)
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
            self._ended = time.monotonic()


def stop():
    """End the bake that runs, and wait for it."""
    global job
    if job is not None:
        job.cancel()
        job.wait()
        job = None
