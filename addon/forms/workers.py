"""Jobs over several processes, in order."""
import os
import threading


def mapped(function, jobs, workers=None):
    """Results of `function` over `jobs` in order, a generator: in `workers` processes (one a core), or here when 1.

    Closing it, or an error, cancels what has not begun.
    """
    workers = workers or os.cpu_count() or 1
    if workers == 1:
        yield from map(function, jobs)
        return
    from concurrent.futures import ProcessPoolExecutor  # takes long to import, and is not needed inside Blender

    with ProcessPoolExecutor(workers, initializer=_end_with_parent) as pool:
        try:
            yield from pool.map(function, jobs, chunksize=4)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _end_with_parent():
    """End this process when the one that made it is killed: it would wait for jobs for ever."""
    from multiprocessing import connection, parent_process

    def watch():
        connection.wait([parent_process().sentinel])
        os._exit(1)

    threading.Thread(target=watch, name="Plausible BRDF parent", daemon=True).start()
