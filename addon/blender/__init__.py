"""The part that lives in Blender: registration, properties, operators, panels, nodes and materials."""
import contextlib

_registered = None


def register():
    """Register everything. What fails is raised, after all that was registered before it is taken back."""
    import bpy

    from . import (
        add_menu,
        asset_library,
        bakes,
        cache,
        furnace_test,
        luts,
        operators,
        panels,
        preferences,
        properties,
        rebake,
        switches,
        upgrade,
        watch,
    )

    global _registered
    if _registered is not None:
        raise RuntimeError("Plausible BRDF is registered already")
    with contextlib.ExitStack() as undo:
        for module in (properties, operators, switches, furnace_test, add_menu, bakes, panels, preferences):
            for cls in module.CLASSES:
                bpy.utils.register_class(cls)
                undo.callback(bpy.utils.unregister_class, cls)
        bpy.types.Material.plausible_brdf = bpy.props.PointerProperty(type=properties.PlausibleMaterial)
        undo.callback(delattr, bpy.types.Material, "plausible_brdf")
        undo.callback(cache.stop)
        undo.callback(luts.stop)
        undo.callback(rebake.stop)
        add_menu.register_menu()
        undo.callback(add_menu.unregister_menu)
        for handlers, handler in ((bpy.app.handlers.load_post, upgrade.on_load),
                                  (bpy.app.handlers.depsgraph_update_post, watch.on_update)):
            handlers.append(handler)
            undo.callback(handlers.remove, handler)
        undo.callback(watch.stop)
        undo.callback(furnace_test.stop)
        asset_library.register()
        undo.callback(asset_library.unregister)
        luts.choose_folder()
        _registered = undo.pop_all()


def unregister():
    """Take back all that `register` did, last first."""
    global _registered
    registered, _registered = _registered, None
    if registered is not None:
        registered.close()
