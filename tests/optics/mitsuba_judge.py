"""Mitsuba's verdict on models, in a separate process: Mitsuba and Blender each bring an LLVM, and a process bears one.

    python tests/optics/mitsuba_judge.py chi2 JOBS.json     prints the result of its chi-square test of each job
    python tests/optics/mitsuba_judge.py render JOBS.json   renders each job, and writes its pictures as .npy

Jobs are lists of dicts; the functions below give their keys. Results are JSON on standard output.
"""
import contextlib
import ctypes
import json
import os
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
with contextlib.suppress(OSError):
    # Dr.Jit takes any LLVM it finds. Of Debian's versions, 15 and 16 cannot compile its code for AVX-512; 19 can.
    ctypes.CDLL("libLLVM.so.19.1")
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", "libLLVM.so.19.1")

from addon.brdf import MODELS


def chi2(mi, jobs):
    """Tests each job {"name", "model", "parameters", "view": [x, y, z]}: {"name", "p_value", "passes", "messages"}.

    Optional keys: "claimed" are the density's parameters where they differ, "seed" is the test's seed, and "tests" is
    the number of tests that together pass with probability 99 %.
    """
    from mitsuba.chi2 import ChiSquareTest, SphericalDomain

    rows = []
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
        rows.append({"name": job["name"], "p_value": float(test.p_value), "passes": bool(passes),
                     "messages": test.messages})
    return rows


def render(mi, jobs):
    """Renders a ball of radius 1 at the origin for each job; returns the paths of the pictures.

    A job is {"model", "parameters", "light", "resolution", "width", "samples", "seeds", "output"}. The file `output`
    receives an array (seeds, resolution, resolution, 3), row 0 at the bottom. The camera looks along -z, orthographic,
    with a picture `width` wide and +y up; a pixel is the mean over its square. `light` holds one of "sky": radiance,
    "image": an equirectangular picture with Blender's axes, "sun": direction, of irradiance pi, and "area": direction,
    with its "distance", "size" and "radiance".
    """
    import drjit as dr

    # The formula is NumPy's: Mitsuba must evaluate it with numbers, not with traces.
    for flag in (dr.JitFlag.SymbolicCalls, dr.JitFlag.SymbolicLoops, dr.JitFlag.SymbolicConditionals):
        dr.set_flag(flag, False)
    mi.register_bsdf("formula", lambda props: formula(mi, props))
    for job in jobs:
        scene = mi.load_dict({
            "type": "scene", "integrator": {"type": "direct"}, "sensor": camera(mi, job), "light": light(mi, job),
            "ball": {"type": "sphere", "bsdf": {"type": "formula", "job": json.dumps(job)}}})
        pictures = [np.array(mi.render(scene, spp=job["samples"], seed=seed))[::-1] for seed in range(job["seeds"])]
        np.save(job["output"], np.array(pictures))
    return [job["output"] for job in jobs]


def camera(mi, job):
    """The orthographic camera of a job, as a dict of Mitsuba's."""
    to_world = mi.ScalarTransform4f
    return {"type": "orthographic", "near_clip": 0.1, "far_clip": 100.0,
            "to_world": to_world().look_at(origin=[0, 0, 10], target=[0, 0, 0], up=[0, 1, 0])
            @ to_world().scale([0.5 * job["width"], 0.5 * job["width"], 1.0]),
            "film": {"type": "hdrfilm", "width": job["resolution"], "height": job["resolution"],
                     "pixel_format": "rgb", "component_format": "float32", "rfilter": {"type": "box"}},
            "sampler": {"type": "multijitter", "sample_count": job["samples"]}}


def light(mi, job):
    """The light of a job, as a dict of Mitsuba's."""
    (kind, value), *more = job["light"].items()
    more = dict(more)
    if kind == "sky":
        return {"type": "constant", "radiance": {"type": "rgb", "value": [value] * 3}}
    if kind == "sun":
        return {"type": "directional", "direction": [-x for x in value],
                "irradiance": {"type": "rgb", "value": [np.pi] * 3}}
    if kind == "image":
        # Its y is Blender's z, and the middle of the picture, its z, is Blender's x.
        turned = mi.ScalarTransform4f([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
        return {"type": "envmap", "filename": value, "to_world": turned}
    position = [x * more["distance"] for x in value]
    half = 0.5 * more["size"]
    return {"type": "rectangle", "to_world": mi.ScalarTransform4f().look_at(
        origin=position, target=[0, 0, 0], up=[0, 1, 0]) @ mi.ScalarTransform4f().scale([half, half, 1.0]),
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [more["radiance"]] * 3}}}


def formula(mi, props):
    """A Mitsuba BSDF of one of our models, with value, sampler and density in NumPy."""
    import drjit as dr

    job = json.loads(props["job"])
    model, parameters = MODELS[job["model"]], job["parameters"]

    def rows(vector):
        """Mitsuba's vectors as (N, 3)."""
        return np.array(vector, dtype=np.float64).T.reshape(-1, 3)

    def of_both(si, wo, active, function, columns):
        """function(view, light) where both are above the horizon, 0 elsewhere: (N, columns)."""
        view, light = np.broadcast_arrays(rows(si.wi), rows(wo))
        up = np.array(active & (si.wi.z > 0.0) & (wo.z > 0.0), dtype=bool)
        up = np.broadcast_to(up, len(view)) & (view[:, 2] > 0.0) & (light[:, 2] > 0.0)
        values = np.zeros((len(view), columns))
        if up.any():
            values[up] = function(unit(view[up]), unit(light[up])).reshape(up.sum(), -1)
        return values

    def unit(vector):
        return vector / np.linalg.norm(vector, axis=1, keepdims=True)

    class Formula(mi.BSDF):
        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide]
            self.m_flags = self.m_components[0]

        def eval(self, ctx, si, wo, active=True):
            value = of_both(si, wo, active, lambda view, light: model.evaluate(view, light, **parameters)
                            .reshape(len(light), -1) * light[:, 2:], 3)
            return mi.Color3f(value.T)

        def pdf(self, ctx, si, wo, active=True):
            return mi.Float(of_both(si, wo, active, lambda view, light: model.pdf(view, light, **parameters), 1)[:, 0])

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def sample(self, ctx, si, sample1, sample2, active=True):
            view, u = rows(si.wi), np.array(sample2, dtype=np.float64).T.reshape(-1, 2)
            up = np.broadcast_to(np.array(active, dtype=bool), len(view)) & (view[:, 2] > 0.0)
            drawn = np.tile([0.0, 0.0, -1.0], (len(view), 1))
            if up.any():
                drawn[up] = model.sample(unit(view[up]), u[up], **parameters)
            result = mi.BSDFSample3f()
            result.wo = mi.Vector3f(drawn.T)
            result.pdf = self.pdf(ctx, si, result.wo, active)
            result.eta = 1.0
            result.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            result.sampled_component = mi.UInt32(0)
            weight = self.eval(ctx, si, result.wo, active) / result.pdf
            return result, dr.select(result.pdf > 0.0, weight, 0.0)

        def to_string(self):
            return f"Formula[{job['model']}]"

    return Formula(props)


def main(what, path):
    """Does the jobs of the file `path`; `what` is chi2 or render."""
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    jobs = json.loads(Path(path).read_text(encoding="utf-8"))
    with contextlib.redirect_stdout(sys.stderr):
        results = {"chi2": chi2, "render": render}[what](mi, jobs)
    print(json.dumps(results))


if __name__ == "__main__":
    main(*sys.argv[1:])
