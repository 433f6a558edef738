"""Measures a user's waits: for the compiler, and for the first pixel of a scene just opened."""
import time

import numpy as np

from ... import brdf
from ...backends.osl import assembler, estimator
from ...measure import plots, scene, specimen
from . import nearest
from .clock import milliseconds
from .efficiency import timed


def measure(effort, progress, models=None) -> dict:
    """{rows: [{model, assemble_ms, compile_ms, bytes, bake_s, first_pixel_ms, closure_ms}]}, processor time.

    `bake_s` is the time to bake a model's lobe rows, null for models that are not baked. The first pixel is of a scene
    that Cycles loads anew; `closure_ms` is the same for the nearest closure in OSL.
    """
    from ...blender.backend import osl

    rows, chosen = [], [brdf.find_model(name) for name in models or brdf.MODELS]
    for i, model in enumerate(chosen):
        began = time.process_time()
        mine = specimen.of_model(model.id)
        bake = time.process_time() - began if estimator.is_baked(model) else None
        text = assembler.assemble(model)
        closure, _ = nearest.natives(model, model.resolve({}))
        first = {name: _first_pixel(material, effort.repeats)
                 for name, material in (("ours", mine.material), ("closure", closure.material))}
        rows.append({
            "model": model.id, "assemble_ms": milliseconds(lambda m=model: assembler.assemble(m), effort.repeats),
            "compile_ms": milliseconds(lambda m=model, t=text: osl.compile_text(m, t), effort.repeats),
            "bytes": len(osl.compile_text(model, text)), "bake_s": bake,
            "first_pixel_ms": first["ours"], "closure_ms": first["closure"],
        })
        progress(i + 1, len(chosen))
    return {"rows": rows}


def _first_pixel(material, repeats):
    """Milliseconds of a render of one sample in a scene that Cycles loads anew."""
    with scene.MeasuringScene(material, scene.PLANE, 4) as stage:
        stage.sky(1.0)
        stage.look_from((0.6, 0.0, 0.8))
        stage.scene.render.use_persistent_data = False
        stage.render(1)
        return 1e3 * float(np.median([timed(stage, 1, i)[0] for i in range(repeats)]))


def lines(report):
    """Yields a head and a line for each model."""
    yield f"{'':26} assemble  compile  bytecode     bake  first pixel  nearest closure's"
    for row in report["rows"]:
        bake = "       -" if row["bake_s"] is None else f"{row['bake_s']:6.1f} s"
        yield (f"{row['model']:26} {row['assemble_ms']:5.0f} ms {row['compile_ms']:5.0f} ms "
               f"{1e-3 * row['bytes']:6.0f} kB {bake} {row['first_pixel_ms']:9.0f} ms {row['closure_ms']:15.0f} ms")


def draw(report):
    """Three bars for each model: the compiler, the first pixel, and the first pixel of a closure."""
    plt = plots._pyplot()
    rows = report["rows"][::-1]
    figure, axis = plt.subplots(figsize=(8.0, 1.4 + 0.3 * len(rows)), layout="constrained")
    y = np.arange(len(rows))
    for i, (key, label) in enumerate((("compile_ms", "compiling the shader"), ("first_pixel_ms", "first pixel"),
                                      ("closure_ms", "first pixel of the nearest closure"))):
        axis.barh(y + 0.26 * (1 - i), [row[key] for row in rows], 0.24, color=plots.VIEWS[i], label=label)
    axis.set(yticks=y, yticklabels=[row["model"] for row in rows], xlabel="milliseconds of processor time")
    axis.legend(frameon=False, fontsize=8)
    return figure
