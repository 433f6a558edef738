"""`plausible docs`."""
from pathlib import Path

from ... import brdf
from ...cli import CommandError, require
from ..pages import links, manual, write

DESCRIPTION = ("Write the models' pages and their index from the registry, and the manual of all pages, which ships in "
               "the extension; with --pictures also the models' pictures, rendered in Cycles, which "
               "takes a minute a model.")
ROOT = write.DOCS.parent


def add_arguments(parser):
    parser.add_argument("model", nargs="*", metavar="MODEL", help="models whose pictures are drawn (default: all)")
    parser.add_argument("--pictures", action="store_true", help="draw pictures, too")
    parser.add_argument("--check", action="store_true",
                        help="write nothing; fail where a page is outdated or a link is broken")
    parser.add_argument("--output", type=Path, default=write.MODEL_PAGES, metavar="DIR",
                        help="folder of the pages (the repository's by default)")


def run(arguments):
    models = [brdf.find_model(name) for name in arguments.model or brdf.MODELS]
    if arguments.model and not arguments.pictures:
        raise CommandError("MODEL goes with --pictures: pages are written all at once")
    if arguments.check:
        return _check(arguments.output)
    for path in write.write(arguments.output):
        print(path)
    if arguments.output == write.MODEL_PAGES:
        require("markdown", "demo")
        print(manual.write())
    if arguments.pictures:
        require("bpy", "render")
        require("matplotlib", "demo")
        from ..figures import models as pictures

        for model in models:
            print(pictures.write(model, arguments.output), flush=True)
    return None


def _check(folder):
    complaints = [f"{folder / name} is not what `plausible docs` writes" for name in write.outdated(folder)]
    if manual.is_outdated():
        complaints.append(f"{manual.MANUAL} is not of today's pages: run `plausible docs`")
    for page in (ROOT / "README.md", *sorted(write.DOCS.rglob("*.md"))):
        complaints += [f"{page.relative_to(ROOT)}: {target} leads nowhere" for target in links.broken(page)]
    print("\n".join(complaints) or "every page is today's, and every link leads to a file")
    return 1 if complaints else 0
