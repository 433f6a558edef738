"""The microfacets of a row's base, as Cycles evaluates them."""
import numpy as np

from ...models.microfacet import beckmann_lambda

LEAST_HEIGHT = 0.05  # least height of the view's mirror direction by a useful facet, in parts of the view's height


def facet_value(slopes, widths, view, light) -> np.ndarray:
    """f (N·L) in 1/sr of Cycles' Beckmann closure, (...), at one `view` (3,) and lights (..., 3).

    The facet's normal leans by `slopes` (2,), and the facet has the `widths` (2,) along x and y. Masking and shadowing
    use a rational fit. Source: Walter et al. 2007, eq. 20, 25.
    """
    # The facet's own frame: its normal, and the axes that Cycles derives from the tangent x.
    normal = np.array([*slopes, 1.0]) / np.sqrt(1.0 + slopes[0] ** 2 + slopes[1] ** 2)
    across = np.cross(normal, [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    frame = np.stack([np.cross(across, normal), across, normal])
    v, lit, h = frame @ view, light @ frame.T, (light + view) @ frame.T
    seen = (lit[..., 2] > 0.0) & (h[..., 2] > 0.0)
    if v[2] <= 0.0:
        return np.zeros(light.shape[:-1])
    # D / (4 (N·V)) over masking and shadowing.
    slope2 = sum((h[..., i] / (np.maximum(h[..., 2], 1e-9) * widths[i])) ** 2 for i in (0, 1))
    cos2 = np.maximum(h[..., 2], 0.0) ** 2 / np.maximum((h * h).sum(axis=-1), 1e-18)
    d = np.exp(-slope2) / (np.pi * widths[0] * widths[1] * np.maximum(cos2, 1e-9) ** 2)
    return np.where(seen, d / (4.0 * v[2] * (1.0 + _lambda(v, widths) + _lambda(lit, widths))), 0.0)


def _lambda(direction, widths):
    """Smith's Lambda of directions (..., 3) in a facet's own frame."""
    slope2 = sum((direction[..., i] * widths[i]) ** 2 for i in (0, 1)) / np.maximum(direction[..., 2] ** 2, 1e-12)
    return beckmann_lambda(slope2)


def row_facet_value(layout, view, slopes, widths, light) -> np.ndarray:
    """`facet_value` of a row's facet, or of a pair.

    A facet of a round formula off the plane of incidence stands for a pair. The other facet leans to the other side.
    """
    value = facet_value(slopes, widths, view, light)
    if slopes[1] and layout.azimuths == 1:
        value = value + facet_value((slopes[0], -slopes[1]), widths, view, light)
    return value


def is_useful(view, slopes) -> bool:
    """Whether a facet mirrors the `view` (3,) above the horizon: Cycles bends the normals of all other facets."""
    normal = np.array([*slopes, 1.0]) / np.sqrt(1.0 + slopes[0] ** 2 + slopes[1] ** 2)
    return 2.0 * (normal @ view) * normal[2] - view[2] > LEAST_HEIGHT * view[2]
