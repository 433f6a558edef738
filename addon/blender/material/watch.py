"""Reacts to edits outside the panel: in the node editor, by a script, by undo."""
import bpy

from . import groups, materials, row_jobs

_changed = set()  # full names of materials whose nodes have changed since the last look


@bpy.app.handlers.persistent
def on_update(scene, depsgraph):
    """Collect changed materials. A timer updates them, as a handler of the depsgraph must not edit data."""
    if bpy.app.background or not depsgraph.id_type_updated("MATERIAL"):  # timers do not run in background mode
        return
    _changed.update(update.id.name_full for update in depsgraph.updates if isinstance(update.id, bpy.types.Material))
    if _changed and not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=0.1)


def _look():
    """Update the viewport look of the changed materials, and bake their lobe rows where stale."""
    names = set(_changed)
    _changed.clear()
    for material in bpy.data.materials:
        node = groups.find_node(material) if material.name_full in names else None
        if node is None or not material.is_editable:
            continue
        materials.update_viewport(material)
        row_jobs.follow(material, node)


def start():
    """Start watching."""
    bpy.app.handlers.depsgraph_update_post.append(on_update)


def stop():
    """Stop watching, and drop the collected materials."""
    if on_update in bpy.app.handlers.depsgraph_update_post:
        bpy.app.handlers.depsgraph_update_post.remove(on_update)
    _changed.clear()
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
