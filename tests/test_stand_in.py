"""The stand-in renders as its formula: the nodes inside a group, and what is written for a baked model."""
import numpy as np
import pytest

from addon import create_material, measure
from addon.backends.nodes import principled_bsdf
from addon.brdf import MODELS
from addon.measure import scene

pytestmark = [pytest.mark.blender, pytest.mark.versions]

VIEW = 50.0


def stand_in_alone(material):
    """The node of a material whose stand-in is what Cycles renders."""
    from addon.blender.backend import protocol
    from addon.blender.material import groups

    node = groups.find_node(material)
    surface = material.node_tree.get_output_node("CYCLES").inputs["Surface"]
    material.node_tree.links.new(node.outputs[protocol.STAND_IN], surface)
    return node


def rendered(material, view=VIEW):
    """Albedo (3,) of the stand-in in Cycles, without OSL, and its standard error (3,)."""
    stand_in_alone(material)
    with scene.MeasuringScene(material, scene.PLANE, 8) as place:
        place.scene.cycles.shading_system = False
        place.sky(1.0)
        place.look_from((np.sin(np.radians(view)), 0.0, np.cos(np.radians(view))))
        pixels = place.render(1024).reshape(-1, 3)
    return pixels.mean(axis=0), pixels.std(axis=0, ddof=1) / np.sqrt(len(pixels))


@pytest.mark.parametrize("model_id, given", [
    ("pumped_phong", {"exponent": 30.0, "base_color": (0.9, 0.5, 0.2)}),
    ("phong", {"roughness": 0.7}),
    ("pumped_blinn", {"fresnel_type": "conductor", "exponent": 100.0}),
    ("disk_scaling", {"radius_u": 0.4, "radius_v": 0.7, "base_color": (0.3, 0.6, 0.9)}),
    ("edwards_empirical", {"base_color": (0.3, 0.2, 0.1), "diffuse_color": (0.2, 0.4, 0.6), "exponent": 50.0}),
    ("ward", {"diffuse_color": (0.1, 0.2, 0.3)}),
])
def test_it_is_what_is_said_of_it(model_id, given):
    from addon.backends.nodes import fallback
    from addon.blender.material import groups, sockets

    material = create_material(model_id, **given)
    node = groups.find_node(material)
    mu = np.cos(np.radians([VIEW]))
    expected = sum(share(mu) * principled_bsdf.albedo(inputs, mu)[0]
                   for share, inputs in fallback.parts(MODELS[model_id], sockets.values(node)))
    found, noise = rendered(material)
    # Cycles' tables and ours of what GGX scatters more than once are within half a percent of each other.
    np.testing.assert_allclose(found, expected, atol=0.006 + 5.0 * noise.max())


def test_a_body_goes_dark_towards_grazing_as_schlick_says():
    from addon.backends.nodes import fallback
    from addon.blender.material import groups, sockets

    material = create_material("edwards_empirical", base_color=0.04, diffuse_color=(0.8, 0.4, 0.2), exponent=50.0)
    mu = np.cos(np.radians([75.0]))
    values = sockets.values(groups.find_node(material))
    expected = sum(share(mu) * principled_bsdf.albedo(inputs, mu)[0]
                   for share, inputs in fallback.parts(MODELS["edwards_empirical"], values))
    found, noise = rendered(material, 75.0)
    np.testing.assert_allclose(found, expected, atol=0.006 + 5.0 * noise.max())


@pytest.mark.parametrize("model_id, given", [("pumped_phong", {"exponent": 30.0}), ("disk_scaling", {"radius_u": 0.4})])
def test_its_lobe_is_as_high_as_is_said(model_id, given):
    """The peak goes with the fourth power of the roughness; an albedo hardly knows it."""
    from addon.backends.nodes import fallback
    from addon.blender.material.sockets import values

    material = create_material(model_id, **given)
    node, light = stand_in_alone(material), measure.in_plane([VIEW])
    view = light * [-1.0, 1.0, 1.0]
    ((_, inputs),) = fallback.parts(MODELS[model_id], values(node))
    expected = principled_bsdf.evaluate(inputs, view, light)[0]
    found, noise = measure.goniometer(material, VIEW, light, samples=64)
    np.testing.assert_allclose(found[0], expected, rtol=0.03, atol=5.0 * noise.max())


def test_errors_are_of_these_nodes():
    """About as good as the fit, whose colours make the albedo right first; a wrong roughness shows."""
    from addon.backends.nodes import fallback, principled_fit

    for model_id in ("pumped_phong", "disk_orthogonal", "edwards_fit"):
        model = MODELS[model_id]
        values = {p.id: p.default for p in model.parameters if p.evaluated}
        best = principled_fit.fit(model, values)
        lobe, albedo = fallback.error(model, values)
        assert 0.9 < (lobe + albedo) / (best.lobe_error + best.albedo_error) < 1.1
        (share, inputs), *others = fallback.parts(model, values)
        wide = type(inputs)(inputs.base_color, inputs.metallic, 1.3 * inputs.roughness)
        assert sum(principled_fit.errors(model, values, [(share, wide), *others])) > 1.1 * (lobe + albedo)
