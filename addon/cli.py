"""The command `plausible`, with one subcommand per task. A subcommand's module is imported only when it runs.

A subcommand's module has `DESCRIPTION`, `add_arguments(parser)` and `run(arguments) -> exit code`. It raises a user's
error (a wrong value, an unreadable file, a missing package) as CommandError, ValueError or OSError, and `main` prints
the error as one line. Any other exception is a defect of this project and keeps its traceback.
"""
import argparse
import importlib
import importlib.util
import sys

from . import resources

# {subcommand: (module, summary in --help)}, in the order of --help.
_COMMANDS = {
    "list": ("addon.commands.list", "list the models, their parameters and tables"),
    "bake": ("addon.commands.bake", "compute the albedo tables, or check the shipped ones"),
    "build": ("addon.dev.commands.build", "make the extension's zip"),
    "furnace": ("addon.commands.furnace", "compare the albedo rendered in Cycles with theory"),
    "goniometer": ("addon.commands.goniometer", "compare the lobe rendered in Cycles under a sun with theory"),
    "chi2": ("addon.dev.commands.chi2", "test whether a model's samples follow its density (chi-square)"),
    "portable": ("addon.dev.commands.portable", "test whether a .blend renders the same without the extension"),
    "compare": ("addon.dev.commands.compare", "compare computed properties of the models with published ones"),
    "match": ("addon.commands.match", "find parameters that make one model's lobe as wide as another's"),
    "fit": ("addon.dev.commands.fit", "find parameters that bring a model nearest to another or to data"),
    "figures": ("addon.dev.commands.figures", "plot albedos and lobes"),
    "previews": ("addon.dev.commands.previews", "render the panel's small pictures of models and presets"),
    "demo": ("addon.dev.commands.demo", "build and render the demo scene"),
    "assets": ("addon.dev.commands.assets", "make the asset library that ships with the extension"),
    "docs": ("addon.dev.commands.docs", "write the models' pages from the registry of models"),
    "bench": ("addon.dev.commands.bench", "compare the efficiency with Cycles' own closures"),
}
# The subcommands of this installation. The extension's zip lacks `addon.dev`, and so the developers' subcommands.
COMMANDS = {name: entry for name, entry in _COMMANDS.items()
            if not entry[0].startswith("addon.dev.") or importlib.util.find_spec("addon.dev") is not None}
# Subcommands that work in a checkout only.
_FOR_CHECKOUT = {"assets", "build", "docs", "previews"}


class CommandError(Exception):
    """A failure that `main` prints as one line."""


def require(package, extra):
    """Raise CommandError if `package` cannot be imported. The message names the pip `extra` that installs it."""
    try:
        importlib.import_module(package)
    except ImportError as error:
        raise CommandError(f"needs {package} ({error}); pip install plausible-brdf[{extra}]") from None


def _parser():
    """The parser of `plausible --help`, which lists the subcommands but not their arguments."""
    parser = argparse.ArgumentParser(prog="plausible", description="Physically plausible reflectance for Cycles.")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, (_, summary) in COMMANDS.items():
        commands.add_parser(name, help=summary, add_help=False)
    return parser


def main(argv=None) -> int:
    """Run `plausible` with `argv`, or with the process's arguments.

    Returns the exit code: 0 success, 1 a check failed, 2 the user's error, 130 cancelled by Ctrl+C.
    """
    argv = list(sys.argv[1:] if argv is None else argv)
    # argparse prints the help or the error, and exits.
    if not argv or argv[0] not in COMMANDS:
        _parser().parse_args(argv)
    # Only the subcommand that runs is imported.
    module = importlib.import_module(COMMANDS[argv[0]][0])
    parser = argparse.ArgumentParser(prog=f"plausible {argv[0]}", description=module.DESCRIPTION)
    module.add_arguments(parser)
    arguments = parser.parse_args(argv[1:])
    try:
        if argv[0] in _FOR_CHECKOUT and not resources.IS_CHECKOUT:
            raise CommandError("works in a checkout of the project, whose files it writes or packs")
        return module.run(arguments) or 0
    except (CommandError, ValueError, OSError) as error:
        print(f"plausible {argv[0]}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"plausible {argv[0]}: cancelled", file=sys.stderr)
        return 130


if __name__ == "__main__":
    # This module's name is __main__ here. Subcommands raise the CommandError of `addon.cli`, so that module must run.
    from addon import cli

    sys.exit(cli.main())
