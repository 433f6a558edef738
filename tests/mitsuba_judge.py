"""Mitsuba's verdict on models, in a process of its own: it and Blender each carry an LLVM, and one process bears one.

    python tests/mitsuba_judge.py chi2 JOBS.json     prints what its chi-square test says of each job
    python tests/mitsuba_judge.py render JOBS.json   renders each job, and writes its pictures as .npy

Jobs are lists of dicts; what each holds is said at the functions below. They come back as JSON on standard output.
"""
import contextlib
import json
import os
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
# Debian's; of those before 18 the code generator does not know an instruction that Dr.Jit asks for on AVX-512.
os.environ.setdefault("DRJIT_LIBLLVM_PATH", "libLLVM.so.19.1")

from addon.brdf import MODELS


def chi2(mi, jobs):
    """Of each {"name", "model", "parameters", "view": [x, y, z]}, perhaps with what its density is to be computed by,
    {"claimed": parameters}, and "seed": {"name", "p_value", "passes", "messages"}.

    "tests" is how many there are that together shall pass with 99 %.
    """
    from mitsuba.chi2 import ChiSquareTest, SphericalDomain

    found = []
    for job in jobs:
        model, view = MODELS[job["model"]], np.array([job["view"]])

        def sample(u, job=job, model=model, view=view):
            return mi.Vector3f(model.sample(view, np.array(u, dtype=np.float64).T, **job["parameters"]).T)

        def pdf(direction, job=job, model=model, view=view):
            light = np.array(direction, dtype=np.float64).T
            light = light / np.linalg.norm(light, axis=1, keepdims=True)
            return mi.Float(model.pdf(view, light, **job.get("claimed", job["parameters"])))

        test = ChiSquareTest(SphericalDomain(), sample, pdf, 2, 1_000_000, res=101, ires=8, seed=job.get("seed", 0))
        passes = test.run(significance_level=0.01, test_count=job.get("tests", 1), quiet=True)
        found.append({"name": job["name"], "p_value": float(test.p_value), "passes": bool(passes),
                      "messages": test.messages})
    return found


def main(what, path):
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    jobs = json.loads(Path(path).read_text(encoding="utf-8"))
    with contextlib.redirect_stdout(sys.stderr):
        found = {"chi2": chi2}[what](mi, jobs)
    print(json.dumps(found))


if __name__ == "__main__":
    main(*sys.argv[1:])
