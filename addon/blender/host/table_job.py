"""Background bakes of albedo tables."""
import threading
import time

from ...forms.albedo import bake, sizes, tables
from .table_folder import use_bake_folder

# The running bake, or the last one since Blender started, or None.
job = None


class BakeJob:
    """A bake in a thread of its own, so that Blender stays responsive. The thread never uses bpy.

    Several processes would be faster, but inside Blender each of them would start another Blender.
    `done` and `total` count steps. `table` is the name of the table in progress, `error` the exception that ended the
    bake, or None.
    """

    def __init__(self, names=None, size=sizes.STANDARD):
        self.names, self.size = list(names or tables.TABLES), size
        self.done, self.total, self.table = 0, 1, self.names[0]
        self.error, self.cancelled = None, False
        self._began = self._ended = None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="Plausible BRDF bake", daemon=True)

    def start(self):
        """Start the thread. Raises OSError if the tables' folder cannot be written."""
        use_bake_folder()
        self._began = time.monotonic()
        self._thread.start()

    def cancel(self):
        """Request the end after the current row. Incomplete tables keep their old files."""
        self._stop.set()

    def wait(self):
        """Wait for the end of the thread."""
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
        """Fraction done, 0..1."""
        return self.done / self.total

    @property
    def seconds(self):
        """Duration so far, or of the whole bake once it has ended, in seconds."""
        return (self._ended or time.monotonic()) - self._began

    @property
    def seconds_left(self):
        """Estimated time to the end in seconds, if all steps take equally long."""
        return self.seconds * (self.total / max(self.done, 1) - 1.0)

    def _run(self):
        rows = bake.bake(self.names, workers=1, size=self.size)
        try:
            for self.done, self.total, self.table in rows:  # noqa: B020
                if self._stop.is_set():
                    self.cancelled = self.done < self.total
                    break
        except Exception as error:  # a thread has no caller: the operator reports the error
            self.error = error
        finally:
            rows.close()
            tables.forget()
            self._ended = time.monotonic()


def stop():
    """Cancel a running bake, and wait for its end."""
    global job
    if job is not None:
        job.cancel()
        job.wait()
        job = None
