"""The part that lives in Blender: registration, properties, operators, panels, nodes and materials."""
import contextlib

_registered = None


def register():
    """Register everything. What fails is raised, after all that was registered before it is taken back."""
    import bpy

    from . import energy, icons, luts, materials, operators, panels, preferences, properties

    global _registered
    if _registered is not None:
        raise RuntimeError("Plausible BRDF is registered already")
    with contextlib.ExitStack() as undo:
        icons.load()
        undo.callback(icons.stop)
        properties.declare_model()
        for module in (properties, operators, panels, energy, preferences):
            for cls in module.CLASSES:
                bpy.utils.register_class(cls)
                undo.callback(bpy.utils.unregister_class, cls)
        bpy.types.Material.plausible_brdf = bpy.props.PointerProperty(type=properties.PlausibleMaterial)
        undo.callback(delattr, bpy.types.Material, "plausible_brdf")
        undo.callback(luts.stop)
        undo.callback(energy.stop)
        undo.callback(materials.stop_waiting)
        luts.choose_folder()
        _registered = undo.pop_all()


def unregister():
    """Take back all that `register` did, last first."""
    global _registered
    registered, _registered = _registered, None
    if registered is not None:
        registered.close()
