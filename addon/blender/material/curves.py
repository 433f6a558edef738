"""Keyframe curves and drivers of data blocks, in every version of Blender."""


def curves(thing) -> list:
    """All keyframe curves and drivers of a data block, those in its NLA tracks included."""
    animation = thing.animation_data
    if animation is None:
        return []
    actions = {animation.action, *(strip.action for track in animation.nla_tracks for strip in track.strips)}
    found = list(animation.drivers)
    for action in actions - {None}:
        if hasattr(action, "layers"):  # since 4.4 an action may animate several data blocks
            bags = [bag for layer in action.layers for strip in layer.strips for bag in strip.channelbags]
            found += [curve for bag in bags for curve in bag.fcurves]
        else:
            found += list(action.fcurves)
    return found
