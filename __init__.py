"""The extension's face: Blender imports this file, everything else lies in `addon` and is loaded when it is needed."""


def register():
    from .addon import register as register_addon

    register_addon()


def unregister():
    from .addon import unregister as unregister_addon

    unregister_addon()
