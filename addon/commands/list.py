"""`plausible list`."""
import json
import math

from .. import brdf
from ..brdf import tables

DESCRIPTION = "List the models with their formulas, parameters, tables and sources."


def add_arguments(parser):
    parser.add_argument("model", nargs="?", metavar="MODEL", help="only this model")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments):
    models = list(brdf.MODELS.values())
    if arguments.model:
        models = [brdf.find_model(arguments.model)]
    if arguments.json:
        print(json.dumps([_as_json(model) for model in models], indent=2))
        return
    for model in models:
        print(f"{model.id}: {model.label}\n  {model.description}\n  f = {model.formula}")
        for parameter in model.parameters:
            span = f"{parameter.minimum:g} .. {parameter.maximum:g}" if math.isfinite(parameter.maximum) else ""
            choice = " | ".join(item[0] for item in parameter.items)
            print(f"    {parameter.id:14} {parameter.kind:6} {choice or span:36} default {parameter.default}")
        for name in model.tables:
            print(f"    table {tables.TABLES[name].path}")
        for reference in model.references:
            print(f"    source: {reference}")
        print()


def _as_json(model):
    return {
        "id": model.id, "label": model.label, "description": model.description, "formula": model.formula,
        "references": model.references, "tables": model.tables,
        "parameters": [
            {"id": p.id, "label": p.label, "kind": p.kind, "default": p.default, "help": p.help,
             "minimum": p.minimum if math.isfinite(p.minimum) else None,
             "maximum": p.maximum if math.isfinite(p.maximum) else None, "items": [item[0] for item in p.items]}
            for p in model.parameters
        ],
    }
