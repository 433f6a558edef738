"""`plausible build`."""
import json

from ...cli import CommandError
from ..packaging import archive, checks

DESCRIPTION = ("Check tables and shaders, make the extension's zip, and run Blender's validator on it where bpy is "
               "installed.")


def add_arguments(parser):
    parser.add_argument("--output", metavar="DIR", default="dist", help="folder of the zip (default: %(default)s)")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments):
    checks.check_tables()
    try:
        shaders = checks.check_shaders()
    except RuntimeError as error:
        raise CommandError(str(error)) from None
    path = archive.build(arguments.output)
    validated = checks.validate(path)
    compiled = isinstance(shaders, int)
    report = {"path": str(path.resolve()), "bytes": path.stat().st_size, "files": len(archive.files()),
              "shaders_compiled": shaders if compiled else 0, "validated": validated}
    if arguments.json:
        print(json.dumps(report, indent=2))
        return
    print(report["path"])
    print(f"{report['bytes'] / 1e6:.2f} MB, {report['files']} files; "
          + (f"{shaders} shaders compile" if compiled else f"shaders not compiled: {shaders}") + "; "
          + ("Blender's validator accepts it" if validated else "not validated: bpy is not installed"))
