"""What all tests share: tables put back after each test, which tests run where, and what came out.

A test whose result another version of Blender can change is marked `versions`, or `versions_by_shader` where it has
cases of many models: then the first case of each shader runs in each version. `-m versions` selects these.
"""
import datetime
import json
import os
import time

import kept_bakes
import numpy as np
import pytest
import versions

from addon.backends.osl import assembler
from addon.brdf import MODELS
from addon.forms.albedo import tables
from addon.forms.rows import error as rows_error
from addon.forms.rows import grid, layout, lobe_rows, row_bake


@pytest.fixture(scope="session", autouse=True)
def _kept_bakes_of_the_run(tmp_path_factory):
    """Bakes are kept for all processes of the run; see kept_bakes.py."""
    own = tmp_path_factory.getbasetemp()
    together = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own
    kept_bakes.use(os.environ.get("PLAUSIBLE_BAKES") or together / "bakes")
    kept_bakes.keep(row_bake, "_baked")


@pytest.fixture(autouse=True)
def _bakes_are_kept(request):
    """But not those of tests that may have changed how they come out."""
    changes = "monkeypatch" in request.fixturenames and not request.node.get_closest_marker("keeps_bakes")
    kept_bakes.allow(not changes)
    yield
    kept_bakes.allow(False)


@pytest.fixture
def table_folder(tmp_path):
    """An empty folder that tables are read from and baked to during one test."""
    tables.use_folder(tmp_path)
    yield tmp_path
    tables.use_folder()


@pytest.fixture
def no_weights(monkeypatch):
    """Baked models get a few zeros for weights, at once, in tests that do not render; nobody else gets to see them."""
    from addon.blender.host import row_cache

    monkeypatch.setattr(row_cache, "_memory", {})
    monkeypatch.setattr(grid, "_kept", {})
    few = lobe_rows.LobeRows.zeros(layout.Layout(views=1, azimuths=1, turns=1, cell_rings=1, cell_turns=1))
    known = rows_error.RowsError(np.zeros(1), np.array([0.012]), np.array([-0.001]))
    monkeypatch.setattr(row_bake, "bake", lambda *_: few)
    monkeypatch.setattr(rows_error, "error", lambda model, parameters: known)
    monkeypatch.setattr(rows_error, "largest", lambda *_: known.largest())


@pytest.fixture
def registered():
    """The add-on, registered from the source folder for one test."""
    import addon

    addon.register()
    yield
    addon.unregister()


@pytest.fixture
def bpy(registered):
    """The module bpy, the add-on registered; materials and the groups of nodes they use are removed after the test."""
    import bpy

    yield bpy
    for material in list(bpy.data.materials):
        bpy.data.materials.remove(material)
    for group in list(bpy.data.node_groups):
        bpy.data.node_groups.remove(group)


# Which tests run where.

@pytest.hookimpl(tryfirst=True)  # before -m selects and processes share out
def pytest_collection_modifyitems(items):
    seen = set()
    for item in items:
        if item.get_closest_marker("versions_by_shader"):
            first = (item.nodeid.partition("[")[0], assembler.program_of(MODELS[item.callspec.params["model"]]))
            if first not in seen:
                item.add_marker("versions")
            seen.add(first)
        if _has_shared_fixture(item):
            item.add_marker(pytest.mark.xdist_group(item.path.stem))


def _has_shared_fixture(item):
    """Whether a fixture is made once for all of its module: such tests run in one process."""
    return any(found[-1].scope == "module" for found in item._fixtureinfo.name2fixturedefs.values())


def pytest_runtest_setup(item):
    if "PYTEST_XDIST_WORKER" in os.environ and item.get_closest_marker("blender"):
        _render_in_one_thread()


def _render_in_one_thread():
    """Beside other processes Cycles takes one core, not all."""
    import bpy

    handlers = bpy.app.handlers.render_init
    if _one_thread not in handlers:
        handlers.append(bpy.app.handlers.persistent(_one_thread))


def _one_thread(scene, *_):
    scene.render.threads_mode, scene.render.threads = "FIXED", 1


# What came out.

def pytest_sessionstart(session):
    session.config.stash[_BEGUN] = time.monotonic()


_BEGUN = pytest.StashKey[float]()


def pytest_terminal_summary(terminalreporter, config):
    if hasattr(config, "workerinput") or config.option.collectonly:
        return
    outcomes = {word: {report.nodeid for report in reports if getattr(report, "when", None)}
                for word, reports in terminalreporter.stats.items()}
    seconds = time.monotonic() - config.stash[_BEGUN]
    found = versions.result(outcomes, config.option.markexpr, seconds, datetime.date.today().isoformat())
    terminalreporter.write_line(versions.line(found))
    if "PLAUSIBLE_RESULTS" in os.environ:
        with open(os.environ["PLAUSIBLE_RESULTS"], "a", encoding="utf-8") as file:
            file.write(json.dumps(found) + "\n")
