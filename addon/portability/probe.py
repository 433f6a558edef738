"""A script for a Blender without the extension: opens a .blend, lists the files it needs, and renders it small.

`portable` runs a copy of this script; the last argument is the path of a job. A job is JSON with `blend`, `result` and
`pixels` (paths), `frame` (a number or null), `size` (the picture's longer side in pixels), `samples`, and `alone` (hide
the extension and use factory settings). The script imports no module of ours. It writes JSON to `result` and the
picture (height, width, 4), float32, to `pixels`.
"""
import glob
import json
import os
import re
import sys
import traceback

# Instructions of OSL bytecode that read a file.
READS_FILES = re.compile(r"^\t(texture\w*|environment|gettextureinfo|pointcloud_\w+)\s", re.MULTILINE)
# Collections of bpy.data whose blocks name files, and what each is called.
FILES = {"images": "image", "libraries": "library", "fonts": "font", "sounds": "sound", "movieclips": "movie clip",
         "volumes": "volume", "cache_files": "cache file"}


def main(job):
    """Does a job; returns its result, a dict."""
    if job["alone"]:
        sys.meta_path.insert(0, _Hidden())
    import bpy

    if job["alone"]:
        bpy.ops.wm.read_factory_settings(use_empty=True)
    try:
        # Most render farms do not run a file's scripts either.
        bpy.ops.wm.open_mainfile(filepath=job["blend"], load_ui=False, use_scripts=False)
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[0].removeprefix("Error: ").replace(f'"{job["blend"]}" ', "")
        return {"version": bpy.app.version_string, "error": f"cannot open it: {reason}"}
    # The list of needs is part of the result, whether the render succeeds or not.
    scene = bpy.context.scene
    if job["frame"] is not None:
        scene.frame_set(job["frame"])
    result = {"version": bpy.app.version_string, "scene": scene.name, "frame": scene.frame_current,
              "scenes": scenes(bpy), "scripts": scripts(bpy), "files": files(bpy)}
    if result["scripts"] and not has_osl():
        return {**result, "error": "this Blender was built without Cycles' Open Shading Language"}
    if scene.camera is None or scene.camera.is_missing:
        return {**result, "error": f"cannot render: the camera of scene {scene.name!r} is missing"}
    settle(scene, job["size"], job["samples"])
    tell(job, {**result, "error": "ended while it rendered"})  # the result if Blender crashes
    render(bpy, scene, job["pixels"])
    return result


def tell(job, result):
    """Writes the result of a job to its file."""
    with open(job["result"], "w", encoding="utf-8") as stream:
        json.dump(result, stream)


def has_osl():
    """Whether this Blender can run a Script node. Load bpy first."""
    try:
        import _cycles
    except ImportError:
        return False
    return getattr(_cycles, "with_osl", False)


class _Hidden:
    """An import hook that hides the modules of the extension."""

    def find_spec(self, name, path=None, target=None):
        """Raises ModuleNotFoundError for a module of the extension; leaves others to Python."""
        if name.split(".")[0] == "addon" or "plausible_brdf" in name.split("."):
            raise ModuleNotFoundError(f"{name} is hidden", name=name)


def scenes(bpy):
    """Name, engine, OSL switch and device of each scene."""
    return [{"name": scene.name, "engine": scene.render.engine, "osl": scene.cycles.shading_system,
             "device": scene.cycles.device} for scene in bpy.data.scenes]


def scripts(bpy):
    """The Script nodes in use, with the users of each and the texts in its sockets, as dicts."""
    nodes = {}
    for kind in ("materials", "worlds", "lights"):
        for block in getattr(bpy.data, kind):
            if block.users and block.node_tree:
                _collect(bpy, block.node_tree, block.library, f"{kind[:-1]} {block.name_full!r}", nodes, set())
    return list(nodes.values())


def _collect(bpy, tree, library, user, nodes, seen):
    """Adds the Script nodes of a tree and its groups to `nodes` {pointer: dict}; `seen` are names of groups done."""
    for node in tree.nodes:
        group = node.node_tree if node.bl_idname == "ShaderNodeGroup" else None
        if group is not None and group.name_full not in seen:
            seen.add(group.name_full)
            _collect(bpy, group, group.library, user, nodes, seen)
        if node.bl_idname == "ShaderNodeScript":
            key = node.as_pointer()
            nodes.setdefault(key, {**_script(bpy, node, library), "users": []})["users"].append(user)


def _script(bpy, node, library):
    """A Script node as a dict: whether it is external or empty, its path, and the texts in its sockets."""
    external = node.mode == "EXTERNAL"
    path = bpy.path.abspath(node.filepath, library=library) if external else ""
    # A shader can read a file only by certain instructions; an external script's are unknown.
    reads = external or bool(READS_FILES.search(node.bytecode))
    texts = [{"name": socket.name, "identifier": socket.identifier, "reads": reads,
              **_path(socket.default_value, bpy.path.abspath(socket.default_value))}
             for socket in node.inputs if socket.type == "STRING" and socket.default_value and not socket.is_linked]
    return {"external": external, "empty": not external and not node.bytecode, **_path(node.filepath, path),
            "texts": texts}


def files(bpy):
    """The files outside the .blend that data-blocks in use name: [{owner, path, absolute, exists}]."""
    rows, known = [], set()
    for collection, kind in FILES.items():
        for block in getattr(bpy.data, collection):
            path = block.filepath
            packed = getattr(block, "packed_file", None) or getattr(block, "is_archive", False)
            generated = collection == "images" and block.source in ("GENERATED", "VIEWER")
            library = None if collection == "libraries" else block.library
            location = _path(path, bpy.path.abspath(path, library=library))
            known.add(location["absolute"])
            used = any(user.id_type != "BRUSH" for user in block.users_id) if kind == "library" else block.users
            if path and path != "<builtin>" and not packed and not generated and used:
                rows.append({"owner": f"{kind} {block.name_full!r}", **location})
    # All other files that Blender knows, but for text files and libraries that data was appended from.
    known |= {os.path.abspath(bpy.path.abspath(text.filepath, library=text.library)) for text in bpy.data.texts}
    known |= {os.path.abspath(bpy.path.abspath(block.library_weak_reference.filepath))
              for block in bpy.data.user_map() if block.library_weak_reference is not None}
    for path in bpy.utils.blend_paths(absolute=True, packed=False, local=False):
        location = _path(path, path)
        if location["absolute"] not in known:
            known.add(location["absolute"])
            rows.append({"owner": "a file", **location})
    return rows


def _path(path, absolute):
    """{path, absolute, exists} of a path as the file writes it; a sequence exists where one of its files does."""
    absolute = os.path.abspath(absolute) if absolute else ""
    pattern = glob.escape(absolute).replace("<UDIM>", "*").replace("<UVTILE>", "*")
    return {"path": path, "absolute": absolute, "exists": bool(absolute and glob.glob(pattern))}


def settle(scene, size, samples):
    """Makes the picture small, and equal bit for bit at each render; the scene's content stays."""
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
    """Renders the scene; writes its picture (height, width, 4), row 0 at the bottom, to the .npy file `path`."""
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
    except Exception as error:  # the waiting process reports it
        traceback.print_exc()
        RESULT = {"error": f"{type(error).__name__}: {error}"}
    tell(JOB, RESULT)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)  # Blender 4.2 crashes and 4.5 hangs when it leaves with an add-on's classes registered
