"""The command `plausible`: one subcommand a job, each in the room it belongs to and loaded when it is asked for.

A subcommand's module has `DESCRIPTION`, `add_arguments(parser)` and `run(arguments) -> exit code`. What a user can get
wrong (a value, a file, a missing package) is raised there as CommandError, ValueError or OSError and printed as one
line; anything else is our defect and keeps its traceback.
"""
import argparse
import importlib
import importlib.util
import sys

_COMMANDS = {
    "list": ("addon.commands.list", "models, their parameters and tables"),
    "bake": ("addon.commands.bake", "compute the albedo tables, or check the shipped ones"),
    "build": ("addon.dev.commands.build", "make the extension's zip"),
    "furnace": ("addon.commands.furnace", "albedo rendered in Cycles against theory"),
    "goniometer": ("addon.commands.goniometer", "lobe under a sun rendered in Cycles against theory"),
    "chi2": ("addon.dev.commands.chi2", "whether a model's sampler draws with the density that it claims"),
    "portable": ("addon.dev.commands.portable", "whether a .blend renders alone, elsewhere, what it renders here"),
    "compare": ("addon.dev.commands.compare", "computed properties of the models, and what is published of them"),
    "match": ("addon.commands.match", "parameters with which one model is as wide as another"),
    "fit": ("addon.dev.commands.fit", "parameters with which a model comes nearest to another or to data"),
    "figures": ("addon.dev.commands.figures", "plots of albedos and lobes"),
    "previews": ("addon.dev.commands.previews", "the small pictures of models and presets that the panel shows"),
    "demo": ("addon.dev.commands.demo", "build and render the demo scene"),
    "assets": ("addon.dev.commands.assets", "make the asset library that ships with the extension"),
    "docs": ("addon.dev.commands.docs", "write the models' pages from the registry"),
    "bench": ("addon.dev.commands.bench", "efficiency against Cycles' own closures"),
}
# The extension ships without the project's own commands.
COMMANDS = {name: found for name, found in _COMMANDS.items()
            if not found[0].startswith("addon.dev.") or importlib.util.find_spec("addon.dev") is not None}


class CommandError(Exception):
    """A failure to print as one line."""


def require(package, extra):
    """Raise CommandError that names the `extra` to install where `package` cannot be imported."""
    try:
        importlib.import_module(package)
    except ImportError as error:
        raise CommandError(f"needs {package} ({error}); pip install plausible-brdf[{extra}]") from None


def _parser():
    parser = argparse.ArgumentParser(prog="plausible", description="Physically plausible reflectance for Cycles.")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, (_, summary) in COMMANDS.items():
        commands.add_parser(name, help=summary, add_help=False)
    return parser


def main(argv=None) -> int:
    """Run `plausible` with `argv`; returns the exit code: 0 done, 1 a check failed, 2 the call was wrong."""
    argv = list(sys.argv[1:] if argv is None else argv)
    if not argv or argv[0] not in COMMANDS:
        _parser().parse_args(argv)
    module = importlib.import_module(COMMANDS[argv[0]][0])
    parser = argparse.ArgumentParser(prog=f"plausible {argv[0]}", description=module.DESCRIPTION)
    module.add_arguments(parser)
    arguments = parser.parse_args(argv[1:])
    try:
        return module.run(arguments) or 0
    except (CommandError, ValueError, OSError) as error:
        print(f"plausible {argv[0]}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"plausible {argv[0]}: cancelled", file=sys.stderr)
        return 130


if __name__ == "__main__":
    from addon import cli  # not this module, which is called __main__ and whose errors no command raises

    sys.exit(cli.main())
