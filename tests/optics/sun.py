"""A sphere under a sun of no size, pixel by pixel and in total."""
import numpy as np

from addon import brdf, create_material, verify
from addon.verify import room, standards
from optics.furnace import SIGMAS

SUNS = (0.0, 40.0, 65.0, 80.0)
SUN_SAMPLES = 512
TOTAL_BOUND, TOTAL_NOISE = 3e-3, 1.2e-3  # of the sphere's light


def sun_bound(exponent):
    """Allowed mean deviation per pixel of the lit sphere, noise included."""
    return 0.01 if exponent <= 150.0 else 0.02


class Sun:
    """A sphere of `material` under a sun of no size at each angle of `suns`, against what the formula says.

    `pictures` are averages of `samples` samples. Each is made of four parts of other seeds, and their scatter is the
    noise; where it is not below `total_noise` there are more pictures. One scene serves all suns, and only the pixels
    of the highlight are rendered at length; `outside` is the rest of the light, as a part of the whole.
    """

    PARTS, PICTURES = 4, 4

    def __init__(self, material, evaluate, suns, resolution, total_noise=TOTAL_NOISE, samples=SUN_SAMPLES):
        self.wanted, self.samples = 0.7 * total_noise, samples
        self.pictures, self.references, self.covered, self.ratios, self.outside = [], [], [], [], []
        with room.Room(material, room.BALL, resolution, exact_pixels=True) as place:
            place.look_from((0.0, 0.0, 1.0), 2.0 * (1.0 + 1.0 / resolution))
            lamp = place.shine("SUN", (0.0, 0.0, 1.0), energy=room.SUN_ENERGY, angle=0.0)
            for angle in suns:
                direction = np.array([np.sin(np.radians(angle)), 0.0, np.cos(np.radians(angle))])
                place.aim(lamp, direction)
                self._measure(place, verify.local_directions(ball(resolution), direction, margin=0.05), evaluate)
        self.outside, self.bias = np.array(self.outside), np.zeros(len(suns))

    def _measure(self, place, lit, evaluate):
        reference = verify.sphere_reference(evaluate, lit)
        bright = reference.max(axis=-1) > 1e-4 * reference.max()
        select(place, None)
        self.outside.append(place.render(16)[lit.covered & ~bright].sum() / reference.sum())
        select(place, bright)
        ratios, pictures = [], []
        while len(pictures) < self.PICTURES:
            parts = [place.render(self.samples // self.PARTS, len(ratios) + i) for i in range(self.PARTS)]
            ratios += [verify.total_ratio(part, reference, bright) for part in parts]
            pictures.append(np.mean(parts, axis=0))
            if self._noise(ratios) <= self.wanted:
                break
        self.pictures.append(pictures)
        self.references.append(reference)
        self.covered.append(bright)
        self.ratios.append(ratios)

    @staticmethod
    def _noise(ratios):
        return np.std(ratios, ddof=1) / np.sqrt(len(ratios))

    def _each(self, figure, channel):
        """The mean of `figure` over the pictures, at each sun."""
        rows = zip(self.pictures, self.references, self.covered, strict=True)
        return np.array([np.mean([figure(picture[..., channel], reference[..., channel], covered)
                                  for picture in pictures]) for pictures, reference, covered in rows])

    def l1(self, channel=slice(None)):
        """Mean deviation per pixel at each sun, noise included, as a part of the mean."""
        return self._each(verify.l1_error, channel) + self.outside

    def total(self, channel=slice(None)):
        """Total over the formula's total less one, at each sun, less what is known to be the instrument's own."""
        return self._each(verify.total_ratio, channel) + self.outside - 1.0 - self.bias

    def noise(self):
        """Standard error of `total` at each sun; a few seeds tell it roughly, so it is not below half of the mean."""
        noise = np.array([self._noise(ratios) for ratios in self.ratios])
        return np.maximum(noise, 0.5 * noise.mean())

    def faults(self, exponent):
        """What is wrong, in words; empty where all is well."""
        found = {"total": np.abs(self.total()) > TOTAL_BOUND + SIGMAS * self.noise(),
                 "L1": self.l1() > sun_bound(exponent), "too noisy to decide": self.noise() > TOTAL_NOISE}
        return [what for what, where in found.items() if where.any()]

    def __repr__(self):
        with np.printoptions(precision=5, suppress=True):
            return (f"total {self.total()} noise {self.noise()} L1 {self.l1()} "
                    f"outside {self.outside} bias {self.bias} pictures {[len(p) for p in self.pictures]}")


def select(place, mask):
    """Render only the smallest rectangle of pixels that holds `mask` (H, W), or all for None."""
    render = place.scene.render
    render.use_border, render.use_crop_to_border = mask is not None, False
    if mask is not None:
        (rows, columns), size = np.nonzero(mask), place.resolution
        render.border_min_x, render.border_max_x = columns.min() / size, (columns.max() + 1) / size
        render.border_min_y, render.border_max_y = rows.min() / size, (rows.max() + 1) / size


def ball(resolution, image=None):
    """The geometry of verify.sphere's picture."""
    width = 2.0 * (1.0 + 1.0 / resolution)
    centres = width * ((np.arange(resolution) + 0.5) / resolution - 0.5)
    x, y = np.meshgrid(centres, centres)
    squared = 1.0 - x * x - y * y
    normal = np.stack([x, y, np.sqrt(np.maximum(squared, 0.0))], axis=-1)
    normal[squared <= 0.0] = np.nan
    return verify.Sphere(image, squared > 0.0, normal, np.array([0.0, 0.0, 1.0]))


def sun_report(model, parameters, suns=SUNS, material=None):
    """What the sun shows of `model`, in a picture just fine enough for its highlight."""
    exponent = parameters["exponent"]
    resolution = 24 if exponent <= 20.0 else 40 if exponent <= 150.0 else 160
    report = Sun(material or create_material(model, **parameters),
                 lambda view, light: brdf.MODELS[model].evaluate(view, light, **parameters), suns, resolution)
    if exponent > 150.0:
        # Blender stores a mesh's normals in 16 bits, which moves so sharp a highlight by up to a per cent of its light.
        # Cycles' own closure, exact, shows by how much.
        closure = standards.phong(exponent / (4.0 if brdf.MODELS[model].lobe.id == "blinn" else 1.0))
        report.bias = Sun(closure.material(), closure.evaluate, suns, resolution).total()
    return report
