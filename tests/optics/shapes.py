"""Parameters that the literature's models are tried with besides their defaults, and that baked ones are rendered with.

A bake takes seconds: tests that ask for the same parameters share it.
"""
COPPER = {"fresnel_type": "schlick", "base_color": (0.95, 0.64, 0.54)}
# Each has another shape, a color that depends on the angle, or a diffuse part.
OTHER = {
    "ward": {"roughness_u": 0.4, "roughness_v": 0.1, "base_color": (0.5, 0.4, 0.3), "diffuse_color": (0.1, 0.2, 0.3)},
    "ward_duer": {"roughness_u": 0.1, "roughness_v": 0.3},
    "ward_bounded": {"roughness_u": 0.35, "roughness_v": 0.2, "diffuse_color": (0.2, 0.1, 0.0)},
    "cook_torrance": {"roughness": 0.45, **COPPER},
    "cosine_microfacet": {"exponent": 12.0, **COPPER, "diffuse_color": (0.1, 0.0, 0.0)},
    "he_torrance": {"sigma": 0.18, "tau": 2.4, "wavelength": 0.6, **COPPER},
    "embrechts": {"smoothness": 3.0, "scattering": 0.8, **COPPER},
    "ashikhmin_shirley": {"exponent_u": 10.0, "exponent_v": 120.0, "base_color": (0.5, 0.3, 0.1),
                          "diffuse_color": (0.3, 0.5, 0.7)},
    "lafortune": {"weight_1": 0.5, "exponent_1": 9.0, "cxy_1": -1.1, "cz_1": 0.9, "weight_3": 0.2,
                  "diffuse_color": (0.1, 0.2, 0.0), "base_color": (0.4, 0.5, 0.6)},
    "phong_original": {"exponent": 9.0, "base_color": (0.9, 0.5, 0.2), "diffuse_color": (0.3, 0.2, 0.1)},
    "blinn_original": {"exponent": 9.0, "base_color": (0.9, 0.5, 0.2), "diffuse_color": (0.3, 0.2, 0.1)},
    "blinn_fresnel": {"exponent": 15.0, **COPPER, "diffuse_color": (0.1, 0.1, 0.1)},
    "weighted_lobes": {"weight_1": 0.3, "exponent_1": 60.0, "weight_2": 0.4, "exponent_3": 2.0, **COPPER},
    "ndf_map": {"rotation": 0.07, **COPPER, "diffuse_color": (0.1, 0.2, 0.3)},
    "kajiya_kay": {"exponent": 12.0, "normalized": False, "diffuse_color": (0.1, 0.2, 0.3)},
}
PUMPED_SHAPES = [("pumped_ward", {"roughness_u": 0.3, "pumps": 1.0, "control": False}),
                 ("pumped_ward_duer", {"pumps": 2.0, "control": False}),
                 ("pumped_cook_torrance", {"roughness": 0.3, "pumps": 1.0}),
                 ("pumped_cosine_microfacet", {"exponent": 20.0, "pumps": 3.0}),
                 ("pumped_he_torrance", {"pumps": 1.0, "control": False}),
                 ("pumped_embrechts", {"smoothness": 3.0, "pumps": 2.5}),
                 ("pumped_ashikhmin_shirley", {"exponent_u": 20.0, "pumps": 1.0}),
                 ("pumped_lafortune", {"pumps": 1.0}),
                 ("pumped_blinn_fresnel", {"exponent": 20.0, "pumps": 2.0, "control": False})]
# Each model that is baked, at least once; the plain ones at the ends of their shapes.
RENDERED = [
    ("ward", {}), ("ward", {"roughness_u": 0.01, "roughness_v": 0.01}),
    ("ward", {"roughness_u": 1.0, "roughness_v": 1.0}),
    ("ward_duer", {"diffuse_color": (0.1, 0.2, 0.3)}), ("ward_bounded", {"roughness_u": 0.4, "roughness_v": 0.4}),
    ("cook_torrance", COPPER), ("cook_torrance", {"roughness": 0.7}), ("cosine_microfacet", {"exponent": 2.0}),
    ("he_torrance", {}), ("he_torrance", {"sigma": 0.02, **COPPER}), ("he_torrance", {"sigma": 1.0, "tau": 3.0}),
    ("embrechts", {"smoothness": 2.0}), ("ashikhmin_shirley", {"base_color": 0.5, "diffuse_color": 0.5}),
    ("lafortune", {}), ("phong_original", {"exponent": 3.0}), ("blinn_original", {"exponent": 10000.0}),
    ("blinn_fresnel", {"exponent": 12.0, **COPPER, "diffuse_color": (0.1, 0.1, 0.1)}), ("weighted_lobes", {}),
    ("pumped_ward", {"roughness_u": 0.3}), ("pumped_ward_duer", {"pumps": 2.0}), ("pumped_cook_torrance", COPPER),
    ("pumped_cosine_microfacet", {"exponent": 8.0}), ("pumped_he_torrance", {"pumps": 3.0}),
    ("pumped_embrechts", {}), ("pumped_ashikhmin_shirley", {"exponent_u": 5.0}),
    ("pumped_lafortune", {"pumps": 2.0}), ("pumped_blinn_fresnel", {"exponent": 1.0, "pumps": 1.0}),
]
STRETCHED = [
    ("ward", {"roughness_u": 0.3, "roughness_v": 0.08}),
    ("ashikhmin_shirley", {"exponent_u": 10.0, "exponent_v": 150.0}), ("kajiya_kay", {"exponent": 20.0}),
]
