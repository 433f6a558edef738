"""Parameters that the literature's models are tried with besides their defaults."""
COPPER = {"fresnel_type": "schlick", "base_color": (0.95, 0.64, 0.54)}
# Another shape, a color that depends on angle, a diffuse part.
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
