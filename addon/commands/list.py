"""`plausible list`."""
import json
import math

from ..backends.osl import estimator
from ..forms.albedo import tables, tabulated
from ..library import presets
from ..models import MODELS, find_model

DESCRIPTION = ("List the models with their formulas, parameters, tables and sources, or the presets by group: "
               "materials by name, each a model with parameters.")


def add_arguments(parser):
    parser.add_argument("model", nargs="?", metavar="MODEL", help="only this model")
    parser.add_argument("--presets", action="store_true",
                        help="list the presets by group; with MODEL, the presets of that model")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments):
    models = list(MODELS.values())
    if arguments.model:
        models = [find_model(arguments.model)]
    if arguments.presets:
        (_print_presets_as_json if arguments.json else _print_presets)({model.id for model in models})
        return
    if arguments.json:
        print(json.dumps([_as_json(model) for model in models], indent=2))
        return
    for model in models:
        print(f"{model.id}: {model.label}\n  {model.description}\n  f = {model.formula}")
        for parameter in model.parameters:
            span = f"{parameter.minimum:g} .. {parameter.maximum:g}" if math.isfinite(parameter.maximum) else ""
            choice = " | ".join(item[0] for item in parameter.items)
            print(f"    {parameter.id:14} {parameter.kind:6} {choice or span:36} default {parameter.default}")
        for name in tabulated.tables_of(model):
            print(f"    table {tables.TABLES[name].path}")
        for reference in model.references:
            print(f"    source: {reference}")
        print()


def _print_presets(models):
    """Prints the groups with the presets of these models, two lines each; those of baked models are marked."""
    for group, members in presets.in_groups().items():
        chosen = {key: preset for key, preset in members.items() if preset.model in models}
        if not chosen:
            continue
        print(group)
        for key, preset in chosen.items():
            print(f"  {key:20} {preset.label:26} {preset.model}{', baked' * estimator.is_baked(MODELS[preset.model])}")
            print(f"    {preset.help}")
        print()


def _print_presets_as_json(models):
    print(json.dumps([{"id": key, "group": preset.group, "label": preset.label, "model": preset.model,
                       "help": preset.help, "parameters": preset.parameters}
                      for key, preset in presets.PRESETS.items() if preset.model in models], indent=2))


def _as_json(model):
    return {
        "id": model.id, "label": model.label, "description": model.description, "formula": model.formula,
        "references": model.references, "tables": tabulated.tables_of(model),
        "parameters": [
            {"id": p.id, "label": p.label, "kind": p.kind, "default": p.default, "help": p.help,
             "minimum": p.minimum if math.isfinite(p.minimum) else None,
             "maximum": p.maximum if math.isfinite(p.maximum) else None, "items": [item[0] for item in p.items]}
            for p in model.parameters
        ],
    }
