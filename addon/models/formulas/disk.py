"""Lumps on the halfway vector disk by two projections, the paper's two BRDFs of several lumps, and a reciprocal one."""
from ..disk import ORTHOGONAL, SCALING
from ..disk_model import DiskModel, LumpRule
from ..lobe_model import LobeModel
from ..lobes import DISK
from ..parameters import COLOUR, DATA_FIT, EDGE, EMPIRICAL, ESTIMATOR, LUMP, PUMPING, ROTATION, SHAPE, TANGENT
from ..registry import register
from .phong import NEUMANN

EDWARDS = ("Edwards, Boulos, Johnson, Shirley, Ashikhmin, Stark, Wyman, The halfway vector disk for BRDF modeling, "
           "ACM Transactions on Graphics 25(1), 2006")

register(DiskModel(
    id="disk_scaling", label="Disk Lump",
    description="A lump on the halfway vector disk: no light lost at any angle, off-specular peaks; not reciprocal",
    parameters=LUMP + ROTATION + EDGE + TANGENT + ESTIMATOR,
    projection=SCALING, lumps=(LumpRule("exponent", ("radius_u", "radius_v")),),
    formula="F p(h) (N·V)² / (4 (N·L)(L·H)(N·H)³), h = (N·V)/(N·H) H", references=(EDWARDS + ", eq. 20, 27",),
))
register(DiskModel(
    id="disk_orthogonal", label="Disk Lump, Orthogonal",
    description="A lump on the disk by the orthogonal projection: narrower, and loses what leaves the disk at grazing",
    parameters=LUMP + ROTATION + EDGE + TANGENT + ESTIMATOR,
    projection=ORTHOGONAL, lumps=(LumpRule("exponent", ("radius_u", "radius_v"), held=False),),
    formula="F p(h) |V+L|² / (4 (L·H)²), h in-plane part of V+L", references=(EDWARDS + ", eq. 24, 27",),
))
register(DiskModel(
    id="edwards_empirical", label="Edwards Empirical",
    description="Diffuse, specular and retroreflective at once, conserving energy: brushed metal, paint, road signs",
    parameters=EMPIRICAL + ROTATION + TANGENT + ESTIMATOR,
    projection=SCALING,
    lumps=(LumpRule("exponent", ("radius_u", "radius_v"), "grazing_exponent", share="retro", rest=True),
           LumpRule("retro_exponent", ("retro_radius_u", "retro_radius_v"), "retro_grazing_exponent", retro=True,
                    share="retro")),
    formula="(1-F) C_d/π + F [(1-k) specular lump + k retroreflective lump]",
    references=(EDWARDS + ", eq. 30, 32, 33",),
))
register(DiskModel(
    id="edwards_fit", label="Edwards Data Fit",
    description="Two specular lumps by the orthogonal projection, to fit measured data; renormalized it loses no light",
    parameters=DATA_FIT + ESTIMATOR,
    projection=ORTHOGONAL,
    lumps=(LumpRule("exponent", ("radius",), held=False, share="blend", rest=True),
           LumpRule("second_exponent", ("second_radius",), held=False, share="blend")),
    widened_with=("second_exponent",),
    formula="(1-F) C_d/π + F [(1-k) first lump + k second lump]", references=(EDWARDS + ", eq. 34, 35, 36",),
))
register(LobeModel(
    id="reciprocal_disk", label="Reciprocal Disk",
    description="The disk's lump made reciprocal by a geometric mean, and pumped up by its own albedo",
    lobe=DISK, correction="pumped", parameters=SHAPE + PUMPING[:1] + COLOUR + ESTIMATOR,
    formula="√(f(V,L) f(L,V)) / D, f the disk lump's", references=(EDWARDS + ", eq. 20, 26", NEUMANN + ", eq. 16, 20"),
))
