"""A sphere under a sun of no size, compared with the formula pixel by pixel and in total."""
import numpy as np

from addon import brdf, create_material, measure
from addon.measure import scene, standards
from optics.furnace import SIGMAS

SUNS = (0.0, 40.0, 65.0, 80.0)  # degrees from the camera's axis
SUN_SAMPLES = 512
TOTAL_BOUND, TOTAL_NOISE = 3e-3, 1.2e-3  # of the sphere's light


def sun_bound(exponent):
    """Allowed mean deviation per pixel of the lit sphere, noise included."""
    return 0.01 if exponent <= 150.0 else 0.02


class Sun:
    """A sphere of `material` under a sun of no size at each angle of `suns` (degrees), compared with the formula.

    A picture is the average of `samples` samples, of PARTS renders with different seeds. The renders' scatter gives
    the noise. Up to PICTURES pictures are rendered, until the noise of the total is below 0.7 `total_noise`. One scene
    serves all suns. Only the highlight's pixels are rendered with all samples; `outside` is the light of the others, as
    a part of the whole.
    """

    PARTS, PICTURES = 4, 4

    def __init__(self, material, evaluate, suns, resolution, total_noise=TOTAL_NOISE, samples=SUN_SAMPLES):
        self.wanted, self.samples = 0.7 * total_noise, samples
        self.pictures, self.references, self.covered, self.ratios, self.outside = [], [], [], [], []
        with scene.MeasuringScene(material, scene.BALL, resolution, exact_pixels=True) as stage:
            stage.look_from((0.0, 0.0, 1.0), 2.0 * (1.0 + 1.0 / resolution))
            lamp = stage.shine("SUN", (0.0, 0.0, 1.0), energy=scene.SUN_ENERGY, angle=0.0)
            for angle in suns:
                direction = np.array([np.sin(np.radians(angle)), 0.0, np.cos(np.radians(angle))])
                stage.aim(lamp, direction)
                self._measure(stage, measure.local_directions(ball(resolution), direction, margin=0.05), evaluate)
        self.outside, self.bias = np.array(self.outside), np.zeros(len(suns))

    def _measure(self, stage, lit, evaluate):
        """Renders the sphere under one sun and stores the pictures, the reference and the ratios of their totals."""
        reference = measure.sphere_reference(evaluate, lit)
        # The dim pixels get few samples.
        bright = reference.max(axis=-1) > 1e-4 * reference.max()
        select(stage, None)
        self.outside.append(stage.render(16)[lit.covered & ~bright].sum() / reference.sum())
        select(stage, bright)
        # The bright pixels get pictures until the noise is low.
        ratios, pictures = [], []
        while len(pictures) < self.PICTURES:
            renders = [stage.render(self.samples // self.PARTS, len(ratios) + i) for i in range(self.PARTS)]
            ratios += [measure.total_ratio(render, reference, bright) for render in renders]
            pictures.append(np.mean(renders, axis=0))
            if self._noise(ratios) <= self.wanted:
                break
        self.pictures.append(pictures)
        self.references.append(reference)
        self.covered.append(bright)
        self.ratios.append(ratios)

    @staticmethod
    def _noise(ratios):
        """Standard error of the mean of the ratios."""
        return np.std(ratios, ddof=1) / np.sqrt(len(ratios))

    def _means(self, figure, channel):
        """The mean of `figure(picture, reference, covered)` over the pictures, at each sun."""
        rows = zip(self.pictures, self.references, self.covered, strict=True)
        return np.array([np.mean([figure(picture[..., channel], reference[..., channel], covered)
                                  for picture in pictures]) for pictures, reference, covered in rows])

    def l1(self, channel=slice(None)):
        """Mean absolute deviation per pixel at each sun, noise included, as a part of the mean."""
        return self._means(measure.l1_error, channel) + self.outside

    def total(self, channel=slice(None)):
        """Total over the formula's total, less one and less the instrument's known `bias`, at each sun."""
        return self._means(measure.total_ratio, channel) + self.outside - 1.0 - self.bias

    def noise(self):
        """Standard error of `total` at each sun, at least half of the suns' mean: few seeds estimate it roughly."""
        noise = np.array([self._noise(ratios) for ratios in self.ratios])
        return np.maximum(noise, 0.5 * noise.mean())

    def faults(self, exponent):
        """Names of the bounds that the renders exceed; empty where all is well."""
        exceeded = {"total": np.abs(self.total()) > TOTAL_BOUND + SIGMAS * self.noise(),
                    "L1": self.l1() > sun_bound(exponent), "too noisy to decide": self.noise() > TOTAL_NOISE}
        return [name for name, suns in exceeded.items() if suns.any()]

    def __repr__(self):
        with np.printoptions(precision=5, suppress=True):
            return (f"total {self.total()} noise {self.noise()} L1 {self.l1()} "
                    f"outside {self.outside} bias {self.bias} pictures {[len(p) for p in self.pictures]}")


def select(stage, mask):
    """Limits renders to the smallest rectangle of pixels around `mask` (H, W); None selects all pixels."""
    render = stage.scene.render
    render.use_border, render.use_crop_to_border = mask is not None, False
    if mask is not None:
        (rows, columns), size = np.nonzero(mask), stage.resolution
        render.border_min_x, render.border_max_x = columns.min() / size, (columns.max() + 1) / size
        render.border_min_y, render.border_max_y = rows.min() / size, (rows.max() + 1) / size


def ball(resolution, image=None):
    """The geometry of the picture of `measure.sphere`, with `image` as its pixels."""
    width = 2.0 * (1.0 + 1.0 / resolution)
    centers = width * ((np.arange(resolution) + 0.5) / resolution - 0.5)
    x, y = np.meshgrid(centers, centers)
    squared = 1.0 - x * x - y * y
    normal = np.stack([x, y, np.sqrt(np.maximum(squared, 0.0))], axis=-1)
    normal[squared <= 0.0] = np.nan
    return measure.Sphere(image, squared > 0.0, normal, np.array([0.0, 0.0, 1.0]))


def sun_report(model, parameters, suns=SUNS, material=None):
    """The `Sun` of `model`, in a picture just fine enough for its highlight."""
    exponent = parameters["exponent"]
    resolution = 24 if exponent <= 20.0 else 40 if exponent <= 150.0 else 160
    report = Sun(material or create_material(model, **parameters),
                 lambda view, light: brdf.MODELS[model].evaluate(view, light, **parameters), suns, resolution)
    if exponent > 150.0:
        # Blender stores a mesh's normals in 16 bits, which changes so sharp a highlight by up to a per cent of its
        # light. Cycles' own closure, which is exact, measures this bias.
        closure = standards.phong(exponent / (4.0 if brdf.MODELS[model].lobe.id == "blinn" else 1.0))
        report.bias = Sun(closure.material(), closure.evaluate, suns, resolution).total()
    return report
