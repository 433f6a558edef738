"""The part that lives in Blender: registration, properties, operators, panels, nodes and materials."""
import contextlib

_registered = None


def _modules():
    """What is registered, in this order. A module may have `prepare`, CLASSES, `start` and, to undo, `stop`."""
    from . import (
        add_menu,
        asset_library,
        bakes,
        cache,
        energy,
        furnace_test,
        icons,
        luts,
        operators,
        panels,
        preferences,
        properties,
        rebake,
        renew,
        switches,
        upgrade,
        watch,
        words,
    )

    return (words, icons, properties, operators, switches, renew, add_menu, bakes, panels, energy, furnace_test,
            preferences, cache, luts, rebake, upgrade, watch, asset_library)


def register():
    """Register everything. What fails is raised, after all that was registered before it is taken back."""
    import bpy

    global _registered
    if _registered is not None:
        raise RuntimeError("Plausible BRDF is registered already")
    with contextlib.ExitStack() as undo:
        for module in _modules():
            if hasattr(module, "prepare"):
                module.prepare()
            for cls in getattr(module, "CLASSES", ()):
                bpy.utils.register_class(cls)
                undo.callback(bpy.utils.unregister_class, cls)
            if hasattr(module, "start"):
                module.start()
            if hasattr(module, "stop"):
                undo.callback(module.stop)
        _registered = undo.pop_all()


def unregister():
    """Take back all that `register` did, last first."""
    global _registered
    registered, _registered = _registered, None
    if registered is not None:
        registered.close()
