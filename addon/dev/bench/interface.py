"""Processor time of the interface's work while the user drags a slider."""
import numpy as np

from ... import brdf
from ...backends.nodes import principled_fit
from ...measure import plots
from ...plots import picture, quick
from .clock import milliseconds


def measure(effort, progress, models=None) -> dict:
    """{rows: [{model, plot_ms, stand_in_ms}]} at defaults: the panel's plot and picture, and a fitted fallback."""
    rows, chosen = [], [brdf.find_model(name) for name in models or brdf.MODELS]
    for i, model in enumerate(chosen):
        values = {p.id: p.default for p in model.parameters if p.evaluated}
        picture.draw(quick.plot(model, values))  # not timed: the first plot may read an image
        rows.append({"model": model.id,
                     "plot_ms": milliseconds(lambda m=model, v=values: picture.draw(quick.plot(m, v)), effort.repeats),
                     "stand_in_ms": milliseconds(lambda m=model, v=values: principled_fit.fit(m, v), effort.repeats)})
        progress(i + 1, len(chosen))
    return {"rows": rows}


def lines(report):
    """Yields a head and a line for each model."""
    yield f"{'ms of processor time':26}  plot  stand-in"
    for row in report["rows"]:
        yield f"{row['model']:26} {row['plot_ms']:5.0f} {row['stand_in_ms']:9.0f}"


def draw(report):
    """Two bars for each model."""
    plt = plots._pyplot()
    rows = report["rows"][::-1]
    figure, axis = plt.subplots(figsize=(8.0, 1.4 + 0.25 * len(rows)), layout="constrained")
    y = np.arange(len(rows))
    for i, (key, label) in enumerate((("plot_ms", "plot and picture"), ("stand_in_ms", "fitted stand-in"))):
        axis.barh(y + 0.2 - 0.4 * i, [row[key] for row in rows], 0.36, color=plots.VIEWS[i], label=label)
    axis.set(yticks=y, yticklabels=[row["model"] for row in rows], xlabel="milliseconds of processor time")
    axis.legend(frameon=False, fontsize=8)
    return figure
