"""Rooms: which may be imported without Blender, and in which order they may know of each other."""
import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
ADDON = ROOT / "addon"
# A room may import rooms of lower rank, and itself. Those of one rank do not know each other.
RANK = {"resources": 0, "version": 1, "assets": 1, "models": 2, "library": 3, "forms": 4, "brdf": 5, "fitting": 5,
        "backends": 6, "plots": 6, "blender": 7, "measure": 8, "statistics": 9, "portability": 9, "cli": 10,
        "commands": 11, "dev": 12, "dev.compare": 12, "dev.pages": 13, "dev.demo": 14, "dev.bench": 14,
        "dev.packaging": 14, "dev.figures": 15, "dev.commands": 16}
BLENDER_RANK = {"host": 0, "backend": 1, "material": 2, "ui": 3}  # of the rooms within Blender's part
# `addon/__init__.py` forwards to the Blender part, when it is asked for what only that has.
FACE = "addon"
NEEDS_BPY = {"blender", "dev.demo"}


def modules():
    """{dotted name: path} of all modules of the package."""
    found = {}
    for path in sorted(ADDON.rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


MODULES = modules()


def imports(name, only_at_load=False):
    """Modules of the package, and other top-level packages, that a module imports."""
    path = MODULES[name]
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    tree = ast.parse(path.read_text(encoding="utf-8"))
    inside_functions = {node for function in ast.walk(tree) if isinstance(function, ast.FunctionDef | ast.Lambda)
                        for node in ast.walk(function)} if only_at_load else set()
    for node in ast.walk(tree):
        if node in inside_functions:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parents = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*parents, *([base] if base else [])])
            for alias in node.names:
                full = f"{base}.{alias.name}"
                yield full if full in MODULES else base


def room(name):
    parts = name.split(".")[1:]
    if parts[:1] == ["dev"]:
        return ".".join(parts[:2])
    return parts[0] if parts else FACE


def test_the_parser_sees_imports():
    """The tests below would pass on an empty list."""
    assert "addon.forms.albedo.tables" in set(imports("addon.forms.albedo.tabulated"))
    assert "addon.forms.base_lobes.fit" in set(imports("addon.commands.bake"))
    assert "addon.forms.base_lobes.fit" not in set(imports("addon.commands.bake", only_at_load=True))
    assert {room(name) for name in MODULES} - {FACE} == set(RANK)


def test_rooms_know_only_lower_rooms():
    wrong = []
    for name in MODULES:
        for other in imports(name):
            if other not in MODULES or FACE in (room(name), room(other)) or room(name) == room(other):
                continue
            if RANK[room(other)] >= RANK[room(name)]:
                wrong.append(f"{name} imports {other}")
    assert wrong == []
    # Models know nothing but NumPy and the standard library, and OpenImageIO where a file needs it.
    for only_at_load, allowed in ((True, {"addon", "numpy"}), (False, {"addon", "numpy", "OpenImageIO"})):
        outside = {(name, other.split(".")[0]) for name in MODULES if room(name) == "models"
                   for other in imports(name, only_at_load)}
        assert {top for _, top in outside} - allowed <= set(sys.stdlib_module_names)
    assert [name for name, top in outside if top == "OpenImageIO"] == ["addon.models.images"]


def test_rooms_of_blenders_part_know_only_lower_ones():
    def within(name):
        return name.split(".")[2]

    ours = [name for name in MODULES if name.startswith("addon.blender.")]
    assert {within(name) for name in ours} == set(BLENDER_RANK)
    wrong = [f"{name} imports {other}" for name in ours for other in imports(name)
             if other in ours and BLENDER_RANK[within(other)] > BLENDER_RANK[within(name)]]
    assert wrong == []


def test_only_lazy_forwarding_at_the_face():
    assert [other for other in imports(FACE, only_at_load=True) if other in MODULES] == []
    assert {room(other) for other in imports(FACE) if other in MODULES} == {"blender"}
    # The face itself may be asked for create_material only inside functions of rooms above Blender's.
    users = {name for name in MODULES for other in imports(name) if other == FACE}
    assert all(RANK[room(name)] > RANK["blender"] for name in users)


def test_no_circular_imports():
    graph = {name: {other for other in imports(name, only_at_load=True) if other in MODULES} for name in MODULES}
    done, path = set(), []

    def visit(name):
        assert name not in path, " -> ".join([*path[path.index(name):], name])
        if name in done:
            return
        path.append(name)
        for other in sorted(graph[name] - {name}):
            # A package's __init__ runs before its modules; that they import from it by name is not a cycle.
            if not name.startswith(f"{other}."):
                visit(other)
        path.pop()
        done.add(name)

    for name in sorted(graph):
        visit(name)
    assert len(done) == len(MODULES)


BLOCKED = """
import importlib, sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in BLOCK:
            raise ModuleNotFoundError(f"{name} is blocked", name=name)

sys.meta_path.insert(0, Blocked())
for name in sys.argv[1:]:
    importlib.import_module(name)
assert not set(BLOCK) & set(sys.modules), sorted(set(BLOCK) & set(sys.modules))
"""


def run_blocked(block, names, after=""):
    script = f"BLOCK = {block!r}\n{BLOCKED}\n{after}"
    return subprocess.run([sys.executable, "-c", script, *names], cwd=ROOT, capture_output=True, text=True)


def test_all_but_blenders_part_imports_without_bpy():
    names = [FACE, *(name for name in MODULES if room(name) not in NEEDS_BPY)]
    result = run_blocked(("bpy", "mathutils", "bl_ext"), names)
    assert result.returncode == 0, result.stderr
    assert run_blocked(("numpy",), ["addon.brdf"]).returncode == 1  # the block blocks


@pytest.mark.parametrize("name", ["addon.brdf", "addon.backends.osl.assembler", "addon.forms.albedo.bake",
                                  "addon.fitting.match", "addon.plots.picture", "addon.cli", "addon.commands.bake",
                                  "addon.commands.list"])
def test_each_room_can_be_imported_first(name):
    """With NumPy alone, as in a Blender that bundles nothing else; and listing models works there."""
    after = "from addon import cli; assert cli.main(['list', 'phong', '--json']) == 0"
    result = run_blocked(("bpy", "scipy", "matplotlib", "OpenImageIO", "colour"), [name], after)
    assert result.returncode == 0, result.stderr
    assert '"id": "phong"' in result.stdout


def test_modules_say_what_they_are_for():
    silent = [name for name, path in MODULES.items() if not ast.get_docstring(ast.parse(path.read_text("utf-8")))]
    assert silent == []


# Tests: what several of them share stands in packages beside them.

SHARED = ("blender_help", "optics", "truth")


def imported_by_tests():
    """(file, module) of each import in the tests and in what they share."""
    tests = ROOT / "tests"
    for path in sorted(tests.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                yield from ((path.relative_to(tests).as_posix(), alias.name) for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                yield path.relative_to(tests).as_posix(), node.module


def test_no_test_file_imports_another():
    found = list(imported_by_tests())
    assert ("test_models.py", "truth") in found or ("test_models.py", "truth.quadrature") in found
    assert [(path, name) for path, name in found if name.split(".")[-1].startswith("test_")] == []


def test_truth_shares_no_code_with_the_product():
    """It reads an image's pixels and a row's layout; formulas are its own, and Blender and what renders are not in it.
    """
    found = {(path, name) for path, name in imported_by_tests() if path.startswith("truth/")}
    assert {name for _, name in found if name.split(".")[0] in ("addon", "bpy", *SHARED)} <= {
        "addon.models", "addon.forms.albedo", "truth.quadrature"}
    assert {path for path, name in found if name.startswith("addon")} == {"truth/literature.py"}
