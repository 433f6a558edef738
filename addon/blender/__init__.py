"""The part that lives in Blender: registration, properties, operators, panels, nodes and materials."""
import contextlib

_registered = None  # the ExitStack that undoes the registration; None while nothing is registered


def _modules():
    """The modules to register, in order.

    A module may have `prepare`, CLASSES and `start`, which run in this order, and `stop`, which undoes `start`.
    """
    from .backend import osl
    from .host import asset_library, row_cache, table_folder, table_job, translation
    from .material import row_jobs, upgrade, watch
    from .ui import add_menu, energy, furnace_test, icons, panels, preferences, properties
    from .ui.operators import (
        backend_choice,
        convert,
        metals,
        new_material,
        open_shading_language,
        presets,
        pumping,
        renew,
        row_bake,
        table_bake,
        update,
        width,
    )

    operators = (new_material, open_shading_language, metals, presets, convert, row_bake, update, width, pumping,
                 backend_choice, renew)
    return (translation, icons, properties, *operators, osl, add_menu, table_bake, panels, energy, furnace_test,
            preferences, row_cache, table_folder, table_job, row_jobs, upgrade, watch, asset_library)


def register():
    """Register all modules. An error unregisters the modules that were registered before it, and is raised again.

    Raises RuntimeError if the extension is registered already.
    """
    import bpy

    global _registered
    if _registered is not None:
        raise RuntimeError("Plausible BRDF is registered already")
    # Each step adds its reverse to `undo`, which runs in reverse order on an error.
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
        # No error: keep the reverse steps for `unregister`.
        _registered = undo.pop_all()


def unregister():
    """Undo `register`, in reverse order. Does nothing if the extension is not registered."""
    global _registered
    registered, _registered = _registered, None
    if registered is not None:
        registered.close()
