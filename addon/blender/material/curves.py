"""Keyframe curves and drivers of data blocks, in all versions of Blender."""


def curves(thing) -> list:
    """All keyframe curves and drivers of a data block, including the curves in its NLA tracks."""
    animation = thing.animation_data
    if animation is None:
        return []
    actions = {animation.action, *(strip.action for track in animation.nla_tracks for strip in track.strips)}
    all_curves = list(animation.drivers)
    for action in actions - {None}:
        if hasattr(action, "layers"):  # since Blender 4.4, where an action may animate several data blocks
            bags = [bag for layer in action.layers for strip in layer.strips for bag in strip.channelbags]
            all_curves += [curve for bag in bags for curve in bag.fcurves]
        else:
            all_curves += list(action.fcurves)
    return all_curves
