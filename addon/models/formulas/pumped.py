"""Albedo pumping-up of every symmetric formula: one mechanism, one model for each."""
from ..pumped_model import pumped
from ..registry import MODELS, register

PUMPED = ("ward", "ward_duer", "cook_torrance", "cosine_microfacet", "he_torrance", "embrechts", "ashikhmin_shirley",
          "lafortune", "blinn_fresnel")

for name in PUMPED:
    register(pumped(MODELS[name]))
