"""Plausible BRDF: physically plausible reflectance in stock Blender.

`brdf` is importable anywhere; what needs bpy is loaded when it is first asked for.
"""


def __getattr__(name):
    if name == "create_material":
        from .blender.material.materials import create_material

        return create_material
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def register():
    """Register the extension with Blender."""
    from .blender import register as register_blender

    register_blender()


def unregister():
    """Unregister the extension, leaving nothing behind."""
    from .blender import unregister as unregister_blender

    unregister_blender()
