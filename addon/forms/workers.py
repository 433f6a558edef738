"""Jobs in several processes, with results in order."""
import os
import threading


def mapped(function, jobs, workers=None):
    """Results of `function` for each of `jobs`, in order, a generator.

    `workers` is the number of processes, by default one a core; with 1 the jobs run in this process. Closing the
    generator, or an error, cancels the jobs that have not begun.
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
    """End this process when its parent process is killed: otherwise it would wait for jobs forever."""
    from multiprocessing import connection, parent_process

    def watch():
        connection.wait([parent_process().sentinel])
        os._exit(1)

    threading.Thread(target=watch, name="Plausible BRDF parent", daemon=True).start()
