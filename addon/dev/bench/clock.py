"""Measures processor time, summed over threads, so that other programs count little."""
import time

import numpy as np


def milliseconds(action, repeats: int) -> float:
    """The median processor time of `repeats` calls of `action()`, in milliseconds."""
    spent = []
    for _ in range(repeats):
        began = time.process_time()
        action()
        spent.append(1e3 * (time.process_time() - began))
    return float(np.median(spent))
