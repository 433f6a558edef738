"""The words that the interface shows, found in its source and its declarations."""
import ast
from pathlib import Path

from addon.brdf import MODELS
from addon.library.presets import PRESETS

BLENDER = Path(__file__).resolve().parents[2] / "addon" / "blender"
_SAYING = {"tr": 0, "draw_text": 2, "Notice": 0, "Cure": 1}  # functions, and which argument is shown


def _texts(node):
    """The texts that an expression may be: also those of both branches of a choice."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return [node.value]
    if isinstance(node, ast.IfExp):
        return _texts(node.body) + _texts(node.orelse)
    if isinstance(node, ast.Dict):
        return [text for value in node.values for text in _texts(value)]
    if isinstance(node, ast.List):
        return [text for value in node.elts for text in _texts(value)]
    return []


def sentences() -> set:
    """Literals that are said, directly or by a name that is given them."""
    found = set()
    for path in BLENDER.rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        named = {}
        for node in ast.walk(tree):
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                named.setdefault(node.targets[0].id, []).extend(_texts(node.value))
        for node in ast.walk(tree):
            name = getattr(getattr(node, "func", None), "id", None)
            if isinstance(node, ast.Call) and name in _SAYING and len(node.args) > _SAYING[name]:
                argument = node.args[_SAYING[name]]
                found.update(_texts(argument))
                found.update(named.get(getattr(argument, "id", None), []))
    return {text for text in found if text}


def labels() -> set:
    """Names of parameters, choices, panels, menus, operators and groups of presets."""
    found = {p.label for model in MODELS.values() for p in model.parameters}
    found |= {item[1] for model in MODELS.values() for p in model.parameters for item in p.items}
    found |= {preset.group for preset in PRESETS.values()}
    for path in BLENDER.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", None) == "bl_label":
                found.update(_texts(node.value))
    return found


def help_texts() -> set:
    return {p.help for model in MODELS.values() for p in model.parameters}
