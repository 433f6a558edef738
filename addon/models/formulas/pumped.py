"""The pumped-up form of symmetric formulas: one mechanism, one model for each formula."""
from ..pumped_model import pumped
from ..registry import MODELS, register

# Ids of the formulas that have a pumped-up form, in the order of registration.
PUMPED = ("ward", "ward_duer", "cook_torrance", "cosine_microfacet", "he_torrance", "embrechts", "ashikhmin_shirley",
          "lafortune", "blinn_fresnel")

for name in PUMPED:
    register(pumped(MODELS[name]))
