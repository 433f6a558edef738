"""A script for a Blender that must not know the extension: opens a .blend, lists what it needs, renders it small.

`portable` runs a copy of it, with the path of a job as its last argument: JSON with `blend`, `result` and `pixels`
(paths), `frame` (a number or null), `size` (pixels of the longer side), `samples`, and `alone` (hide the extension and
forget the user's settings). It imports nothing of ours. `result` receives JSON, `pixels` the picture (height, width, 4)
in float32.
"""
import glob
import json
import os
import re
import sys
import traceback

READS_FILES = re.compile(r"^\t(texture\w*|environment|gettextureinfo|pointcloud_\w+)\s", re.MULTILINE)  # of bytecode
FILES = {"images": "image", "libraries": "library", "fonts": "font", "sounds": "sound", "movieclips": "movie clip",
         "volumes": "volume", "cache_files": "cache file"}


def main(job):
    """Do a job; returns what goes into its `result`."""
    if job["alone"]:
        sys.meta_path.insert(0, _Hidden())
    import bpy

    if job["alone"]:
        bpy.ops.wm.read_factory_settings(use_empty=True)
    try:
        # What scripts in the file would do is not done on most farms either.
        bpy.ops.wm.open_mainfile(filepath=job["blend"], load_ui=False, use_scripts=False)
    except RuntimeError as error:
        words = str(error).strip().splitlines()[0].removeprefix("Error: ").replace(f'"{job["blend"]}" ', "")
        return {"version": bpy.app.version_string, "error": f"cannot open it: {words}"}
    scene = bpy.context.scene
    if job["frame"] is not None:
        scene.frame_set(job["frame"])
    found = {"version": bpy.app.version_string, "scene": scene.name, "frame": scene.frame_current,
             "scenes": scenes(bpy), "scripts": scripts(bpy), "files": files(bpy)}
    if found["scripts"] and not has_osl():
        return {**found, "error": "this Blender was built without Cycles' Open Shading Language"}
    if scene.camera is None or scene.camera.is_missing:
        return {**found, "error": f"cannot render: the camera of scene {scene.name!r} is missing"}
    settle(scene, job["size"], job["samples"])
    tell(job, {**found, "error": "ended while it rendered"})  # what a crash leaves behind
    render(bpy, scene, job["pixels"])
    return found


def tell(job, result):
    """Write the result of a job."""
    with open(job["result"], "w", encoding="utf-8") as stream:
        json.dump(result, stream)


def has_osl():
    """Whether this Blender can run a Script node; bpy has to be loaded before."""
    try:
        import _cycles
    except ImportError:
        return False
    return getattr(_cycles, "with_osl", False)


class _Hidden:
    """Finds no module of the extension, wherever it may be installed."""

    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] == "addon" or "plausible_brdf" in name.split("."):
            raise ModuleNotFoundError(f"{name} is hidden", name=name)


def scenes(bpy):
    """What each scene renders with."""
    return [{"name": scene.name, "engine": scene.render.engine, "osl": scene.cycles.shading_system,
             "device": scene.cycles.device} for scene in bpy.data.scenes]


def scripts(bpy):
    """The Script nodes that something uses, and the texts in their sockets."""
    found = {}
    for kind in ("materials", "worlds", "lights"):
        for block in getattr(bpy.data, kind):
            if block.users and block.node_tree:
                _collect(bpy, block.node_tree, block.library, f"{kind[:-1]} {block.name_full!r}", found, set())
    return list(found.values())


def _collect(bpy, tree, library, user, found, seen):
    for node in tree.nodes:
        group = node.node_tree if node.bl_idname == "ShaderNodeGroup" else None
        if group is not None and group.name_full not in seen:
            seen.add(group.name_full)
            _collect(bpy, group, group.library, user, found, seen)
        if node.bl_idname == "ShaderNodeScript":
            key = node.as_pointer()
            found.setdefault(key, {**_script(bpy, node, library), "users": []})["users"].append(user)


def _script(bpy, node, library):
    external = node.mode == "EXTERNAL"
    path = bpy.path.abspath(node.filepath, library=library) if external else ""
    # Only a shader that calls for an image can read one; what a script outside contains is not known.
    reads = external or bool(READS_FILES.search(node.bytecode))
    texts = [{"name": socket.name, "identifier": socket.identifier, "reads": reads,
              **_place(socket.default_value, bpy.path.abspath(socket.default_value))}
             for socket in node.inputs if socket.type == "STRING" and socket.default_value and not socket.is_linked]
    return {"external": external, "empty": not external and not node.bytecode, **_place(node.filepath, path),
            "texts": texts}


def files(bpy):
    """Files outside that data in use names: {owner, path, absolute, exists}."""
    found, known = [], set()
    for collection, kind in FILES.items():
        for block in getattr(bpy.data, collection):
            path = block.filepath
            packed = getattr(block, "packed_file", None) or getattr(block, "is_archive", False)
            generated = collection == "images" and block.source in ("GENERATED", "VIEWER")
            library = None if collection == "libraries" else block.library
            place = _place(path, bpy.path.abspath(path, library=library))
            known.add(place["absolute"])
            used = any(user.id_type != "BRUSH" for user in block.users_id) if kind == "library" else block.users
            if path and path != "<builtin>" and not packed and not generated and used:
                found.append({"owner": f"{kind} {block.name_full!r}", **place})
    # Whatever else there may be, its kind unknown, but no text and no library that something was appended from.
    known |= {os.path.abspath(bpy.path.abspath(text.filepath, library=text.library)) for text in bpy.data.texts}
    known |= {os.path.abspath(bpy.path.abspath(block.library_weak_reference.filepath))
              for block in bpy.data.user_map() if block.library_weak_reference is not None}
    for path in bpy.utils.blend_paths(absolute=True, packed=False, local=False):
        place = _place(path, path)
        if place["absolute"] not in known:
            known.add(place["absolute"])
            found.append({"owner": "a file", **place})
    return found


def _place(path, absolute):
    """A path as it is written, and where that is; of a sequence of files, one is enough to exist."""
    absolute = os.path.abspath(absolute) if absolute else ""
    pattern = glob.escape(absolute).replace("<UDIM>", "*").replace("<UVTILE>", "*")
    return {"path": path, "absolute": absolute, "exists": bool(absolute and glob.glob(pattern))}


def settle(scene, size, samples):
    """Make a picture small, and the same bits at each render; what the scene shows stays."""
    render, cycles = scene.render, scene.cycles
    scale = size / max(render.resolution_x, render.resolution_y)
    render.resolution_x = max(4, round(scale * render.resolution_x))
    render.resolution_y = max(4, round(scale * render.resolution_y))
    render.resolution_percentage = 100
    render.engine = "CYCLES"
    render.use_compositing = render.use_sequencer = render.use_border = render.use_multiview = False
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "IMAGE"
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode, render.image_settings.color_depth = "RGBA", "32"
    cycles.device, cycles.samples, cycles.time_limit = "CPU", samples, 0.0
    cycles.use_denoising = cycles.use_adaptive_sampling = cycles.use_guiding = False


def render(bpy, scene, path):
    """Render the scene; its picture (height, width, 4), row 0 at the bottom, goes to the .npy file `path`."""
    import numpy as np

    scene.render.filepath = f"{path}.exr"
    bpy.ops.render.render(write_still=True, scene=scene.name)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(pixels)
    np.save(path, pixels.reshape(image.size[1], image.size[0], -1))


if __name__ == "__main__":
    with open(sys.argv[-1], encoding="utf-8") as stream:
        JOB = json.load(stream)
    try:
        RESULT = main(JOB)
    except Exception as error:  # told by the process that waits for the result
        traceback.print_exc()
        RESULT = {"error": f"{type(error).__name__}: {error}"}
    tell(JOB, RESULT)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)  # Blender 4.2 crashes and 4.5 hangs when it leaves with an add-on's classes registered
