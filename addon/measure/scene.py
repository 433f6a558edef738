"""The measuring scene: one object in the dark, with settings under which a Cycles pixel is the integral alone."""
import contextlib
import ctypes
import importlib.util
import io
import math
import os
import sys
import tempfile
from pathlib import Path

import numpy as np

from ..models.errors import ArgumentError

SUN_ENERGY = math.pi  # W/m²; a white Lambertian that faces this sun has radiance 1
PLANE, BALL = "plane", "ball"
_BALL_SUBDIVISIONS = 7  # 81920 triangles, which lie within 4e-5 radii of the sphere


class MeasureError(ValueError):
    """Blender cannot render the measurement; the message names what is missing."""


def require_blender():
    """Returns the module bpy. Raises MeasureError where bpy is not installed or has no Cycles."""
    if importlib.util.find_spec("bpy") is None:
        raise MeasureError("needs Blender's Python module: install it with `pip install bpy`")
    with quiet():
        import bpy
        with contextlib.suppress(ImportError):
            import _cycles  # noqa: F401
            return bpy
    raise MeasureError(f"Blender {bpy.app.version_string} was built without Cycles")


def prepare(scene, material):
    """Sets up a scene for the backends of a material's nodes. Raises MeasureError where one of them cannot run."""
    for backend in set(_backends_in(material.node_tree)) if material.node_tree else ():
        for hindrance in backend.why_not():
            raise MeasureError(hindrance.text)
        backend.prepare(scene)


def _backends_in(tree):
    """Yields the backends of our nodes in a tree and its groups, and OSL's for a user's own Script node."""
    from ..blender import backend
    from ..blender.material import groups

    for node in tree.nodes:
        if groups.model_of(node) is not None:
            yield groups.backend_of(node)
        elif getattr(node, "node_tree", None) is not None:
            yield from _backends_in(node.node_tree)
        elif node.bl_idname == "ShaderNodeScript":
            yield backend.DEFAULT


@contextlib.contextmanager
def quiet():
    """Discards the process's standard output, also that of Blender's C++ code. Standard error still shows."""
    with contextlib.redirect_stdout(io.StringIO()), _quiet_descriptor():
        yield


@contextlib.contextmanager
def _quiet_descriptor():
    """Points the descriptor of the standard output at the null device."""
    try:
        stdout = sys.__stdout__.fileno()
    except (AttributeError, OSError, ValueError):  # no console, as under pythonw
        yield
        return
    # Earlier text belongs to the console, later text does not.
    _flush()
    saved = os.dup(stdout)
    sink = os.open(os.devnull, os.O_WRONLY)
    os.dup2(sink, stdout)
    os.close(sink)
    try:
        yield
    finally:
        _flush()
        os.dup2(saved, stdout)
        os.close(saved)


def _flush():
    """Flushes Python's and C's output buffers."""
    sys.__stdout__.flush()
    with contextlib.suppress(OSError, AttributeError):
        (ctypes.CDLL("ucrtbase") if os.name == "nt" else ctypes.CDLL(None)).fflush(None)


class MeasuringScene:
    """A separate Blender scene: one object with `material`, seen by an orthographic camera.

    `shape` is PLANE (the normal is +z, the tangent +x) or BALL (radius 1 about the origin). The world is black, and
    there are no lights until `sky` and `shine` add them. `resolution` is the width and height in pixels, 4..4096. Use
    it as a context manager: the exit removes all data that it made.

    With `exact_pixels` a pixel sees its center only. Without, a pixel's filter is the usual 1.5 pixels wide; that makes
    no difference on a plane, and shaders that hash the position get more positions.

    Raises ArgumentError for a wrong resolution, MeasureError where Blender or a backend is missing.
    """

    def __init__(self, material, shape: str, resolution: int, exact_pixels: bool = False):
        if int(resolution) != resolution or not 4 <= resolution <= 4096:
            raise ArgumentError("resolution", "range", f"{resolution} is not a whole number from 4 to 4096")
        self.resolution = int(resolution)
        self._bpy = require_blender()
        self._folder = tempfile.TemporaryDirectory(prefix="plausible-")
        self._made = []  # (collection, data-block), to be removed in reverse order
        # The object and its mesh.
        data = self._bpy.data
        self.scene = data.scenes.new("Plausible Room")
        mesh = self._keep(data.meshes, data.meshes.new("Plausible Subject"))
        (_fill_plane if shape == PLANE else _fill_ball)(mesh)
        mesh.materials.append(material)
        self._subject = mesh
        self._add_object("Plausible Subject", mesh)
        # The camera, the world, and the renderer's settings.
        lens = self._keep(data.cameras, data.cameras.new("Plausible Camera"))
        lens.type = "ORTHO"
        self._camera = self.scene.camera = self._add_object("Plausible Camera", lens)
        self.scene.world = self._keep(data.worlds, data.worlds.new("Plausible World"))
        self.sky(0.0)
        _settle(self.scene, self.resolution, exact_pixels)
        prepare(self.scene, material)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        # This frees the renderer first: Blender 4.5 crashes where a scene is removed while a renderer holds it.
        self.scene.render.use_persistent_data = False
        self._bpy.data.scenes.remove(self.scene)
        for collection, block in reversed(self._made):
            collection.remove(block)
        self._folder.cleanup()

    def _keep(self, collection, block):
        """Marks a data-block for removal; returns the block."""
        self._made.append((collection, block))
        return block

    def _add_object(self, name, data):
        """Makes an object of `data` in the scene; returns the object."""
        added = self._keep(self._bpy.data.objects, self._bpy.data.objects.new(name, data))
        added.rotation_mode = "QUATERNION"
        self.scene.collection.objects.link(added)
        return added

    def look_from(self, direction, width: float = 1.0):
        """Points the camera at the origin from the unit vector `direction` (3,); the picture is `width` meters wide."""
        cosine = max(abs(float(direction[2])), 1e-3)
        self._camera.data.ortho_scale = width
        _place(self._camera, direction, max(10.0, 2.0 * width / cosine))  # the lowest pixel stays above the plane
        self._camera.data.clip_end = 1e5

    def sky(self, radiance=0.0, image: str | None = None):
        """Lights the scene by `radiance` (number or RGB) from everywhere, times the equirectangular `image` file."""
        world = self.scene.world
        if world.node_tree is None:
            world.use_nodes = True
        nodes, links = world.node_tree.nodes, world.node_tree.links
        nodes.clear()
        background, output = nodes.new("ShaderNodeBackground"), nodes.new("ShaderNodeOutputWorld")
        links.new(background.outputs[0], output.inputs["Surface"])
        # The brightest channel is the strength, so that the color stays within 0..1.
        color = np.broadcast_to(np.asarray(radiance, dtype=np.float64), (3,))
        strength = max(float(color.max()), 1e-30)
        background.inputs["Color"].default_value = (*(color / strength), 1.0)
        background.inputs["Strength"].default_value = strength
        if image is not None:
            texture = nodes.new("ShaderNodeTexEnvironment")
            texture.image = self._keep(self._bpy.data.images, self._bpy.data.images.load(str(image)))
            links.new(texture.outputs["Color"], background.inputs["Color"])

    def shine(self, kind: str, direction, **settings):
        """Adds a lamp of Blender's `kind` ("SUN", "AREA"); returns its object.

        `direction` (3,) is the unit vector to the lamp. `settings` are properties of the light, and `distance` from the
        origin (meters, 10 by default), which matters for lamps with a position.
        """
        distance = settings.pop("distance", 10.0)
        light = self._keep(self._bpy.data.lights, self._bpy.data.lights.new("Plausible Lamp", kind))
        for name, value in settings.items():
            setattr(light, name, value)
        lamp = self._add_object("Plausible Lamp", light)
        self.aim(lamp, direction, distance)
        return lamp

    @staticmethod
    def aim(lamp, direction, distance: float = 10.0):
        """Moves `lamp` to `distance` meters along the unit vector `direction` (3,), shining at the origin."""
        _place(lamp, direction, distance)

    def floor(self, material):
        """Adds a floor of `material`, 8 meters wide, under the ball."""
        data = self._bpy.data
        mesh = self._keep(data.meshes, data.meshes.new("Plausible Floor"))
        mesh.from_pydata([(x, y, -1.0) for x, y in ((-4, -4), (4, -4), (4, 4), (-4, 4))], [], [(0, 1, 2, 3)])
        mesh.materials.append(material)
        prepare(self.scene, material)
        self._add_object("Plausible Floor", mesh)

    def bounces(self, count: int):
        """Lets light be reflected `count` times; without this call, once."""
        cycles = self.scene.cycles
        cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = count

    def divide(self, materials):
        """Divides the plane into strips side by side, one for each of `materials` (one or more)."""
        mesh, count = self._subject, len(materials)
        # The strips have equal widths and fill the picture of width 1.
        edges = np.linspace(-0.5, 0.5, count + 1)
        mesh.clear_geometry()
        mesh.materials.clear()
        for material in materials:
            mesh.materials.append(material)
            prepare(self.scene, material)
        mesh.from_pydata([(x, y, 0.0) for x in edges for y in (-0.5, 0.5)], [],
                         [(2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1) for i in range(count)])
        mesh.uv_layers.new(name="UVMap")
        for i, face in enumerate(mesh.polygons):
            face.material_index = i

    def render(self, samples: int, seed: int = 0) -> np.ndarray:
        """Renders `samples` (1..2^20) per pixel: radiance (resolution, resolution, 3), float64, row 0 at the bottom."""
        if int(samples) != samples or not 1 <= samples <= 1 << 20:
            raise ArgumentError("samples", "range", f"{samples} is not a whole number from 1 to {1 << 20}")
        self.scene.cycles.samples, self.scene.cycles.seed = int(samples), int(seed)
        path = Path(self._folder.name) / "pixels.exr"
        path.unlink(missing_ok=True)
        self.scene.render.filepath = str(path)
        with quiet():
            self._bpy.ops.render.render(write_still=True, scene=self.scene.name)
            image = self._bpy.data.images.load(str(path))
        image.colorspace_settings.name = "Non-Color"  # reads the file's numbers unchanged
        pixels = np.empty(len(image.pixels), dtype=np.float32)
        image.pixels.foreach_get(pixels)
        self._bpy.data.images.remove(image)
        return pixels.reshape(self.resolution, self.resolution, -1)[..., :3].astype(np.float64)


def _place(body, direction, distance):
    """Moves an object to `distance` along the unit vector `direction`.

    The object's +z points along `direction`, its +y as near to +y as possible. A camera at +z then has +x to its right
    and +y up.
    """
    from mathutils import Matrix, Vector

    z = Vector(direction)
    y = Vector((0.0, 1.0, 0.0)) if abs(z.y) < 0.999 else Vector((0.0, 0.0, -1.0))
    x = y.cross(z).normalized()
    body.location = z * distance
    body.rotation_quaternion = Matrix((x, z.cross(x), z)).transposed().to_quaternion()


def _fill_plane(mesh):
    size = 1e4  # meters: the plane fills the picture at every view angle up to 89.9 degrees
    corners = [(-size, -size, 0.0), (size, -size, 0.0), (size, size, 0.0), (-size, size, 0.0)]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0])


def _fill_ball(mesh):
    """Fills a mesh with an icosphere of radius 1 whose normals are radial, also where a face interpolates them."""
    import bmesh

    shape = bmesh.new()
    bmesh.ops.create_icosphere(shape, subdivisions=_BALL_SUBDIVISIONS, radius=1.0)
    # Flat faces lie below the round surface. With the sphere's volume they lie below it as often as above.
    volume_radius = (shape.calc_volume() / (4.0 / 3.0 * math.pi)) ** (1.0 / 3.0)
    bmesh.ops.scale(shape, verts=shape.verts, vec=[1.0 / volume_radius] * 3)
    shape.to_mesh(mesh)
    shape.free()
    positions = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", positions)
    positions = positions.reshape(-1, 3)
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), dtype=bool))
    mesh.normals_split_custom_set_from_vertices(positions / np.linalg.norm(positions, axis=1, keepdims=True))


def _settle(scene, resolution, exact_pixels):
    """Switches off everything that keeps a pixel from being the mean of independent samples."""
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x = render.resolution_y = resolution
    render.resolution_percentage = 100
    render.use_compositing = render.use_sequencer = False
    render.use_persistent_data = True  # Cycles compiles shaders once, not at each render
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode, render.image_settings.color_depth = "RGB", "32"
    render.image_settings.exr_codec = "NONE"
    scene.view_settings.view_transform = "Raw"
    cycles.device = "CPU"
    cycles.shading_system = False  # see `prepare`
    cycles.use_denoising = cycles.use_adaptive_sampling = cycles.use_guiding = False
    cycles.sampling_pattern = "TABULATED_SOBOL"  # the default pattern correlates the noise of neighboring pixels
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 1
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.light_sampling_threshold = cycles.blur_glossy = 0.0
    cycles.caustics_reflective = True
    cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    cycles.filter_width = 0.01 if exact_pixels else 1.5
