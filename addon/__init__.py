"""Plausible BRDF: physically plausible reflectance in stock Blender.

`addon.brdf` can be imported without Blender. Modules that need bpy are loaded on first use.
"""


def __getattr__(name):
    """Loads `create_material` on first use, since it needs bpy."""
    if name == "create_material":
        from .blender.material.materials import create_material

        return create_material
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def register():
    """Register the extension with Blender."""
    from .blender import register as register_blender

    register_blender()


def unregister():
    """Unregister the extension and remove everything that it registered."""
    from .blender import unregister as unregister_blender

    unregister_blender()
