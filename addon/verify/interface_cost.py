"""What the interface computes while a slider is dragged, in milliseconds of processor time."""
import time

import numpy as np

from ..brdf import MODELS
from ..fitting import principled
from ..plots import picture, quick

TIMES = 5  # of which the median counts; a first one before them may read an image


def measure(model_ids=tuple(MODELS)) -> list:
    """[{model, plot_ms, stand_in_ms}] at default parameters: the panel's plot and picture, and a fitted stand-in."""
    rows = []
    for model_id in model_ids:
        model = MODELS[model_id]
        values = {p.id: p.default for p in model.parameters if p.evaluated}
        rows.append({"model": model_id, "plot_ms": _median(lambda m=model, v=values: picture.draw(quick.plot(m, v))),
                     "stand_in_ms": _median(lambda m=model, v=values: principled.fit(m, v))})
    return rows


def _median(action) -> float:
    action()
    spent = []
    for _ in range(TIMES):
        began = time.process_time()
        action()
        spent.append(1e3 * (time.process_time() - began))
    return float(np.median(spent))
