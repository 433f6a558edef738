"""Albedo tables inside Blender: their folder, and what is wrong with them."""
import shutil
from pathlib import Path

from ...forms import files
from ...forms.albedo import bake, tables
from . import settings

folder_problem = None  # why the folder that the user chose, or the tables baked here, are not used
_problems = {}


def choose_folder():
    """Use the folder that the user chose, else the tables that were baked here, else those of the package.

    A folder that lacks a table, or has one that is not of this version, is not used, and `folder_problem` says why.
    """
    global folder_problem
    folder_problem = None
    wanted = [folder for folder in (_chosen(), own_tables()) if folder is not None]
    for folder in wanted:
        amiss = _amiss(folder)
        if amiss is None:
            return
        folder_problem = folder_problem or amiss
    tables.use_folder()
    if folder_problem:
        folder_problem += ". The shipped tables are used"


def start():
    """Look for tables."""
    choose_folder()


def _chosen():
    chosen = settings.lut_folder()
    return Path(chosen) if chosen else None


def own_tables():
    """The folder of tables that were baked here, or None where none were."""
    folder = settings.granted_folder("luts")
    return folder if folder is not None and any(folder.glob("*.exr")) else None


def _amiss(folder):
    """Use a folder; returns what is wrong with it, or None."""
    tables.use_folder(folder)
    if not folder.is_dir():
        return f"{folder}: there is no such folder"
    missing = [table.path.name for table in tables.TABLES.values() if not table.path.exists()]
    if missing:
        return f"{folder} lacks {', '.join(missing)}; a bake fills it"
    try:
        for name in tables.TABLES:
            tables.in_use(name)
    except tables.TableError as error:
        return str(error)
    return None


def use_bake_folder():
    """Use the folder that a bake writes to: the user's choice, else what Blender grants us, else the folder in use.

    Tables that it lacks are copied there, and so are those that are not usable in our own: until a bake is complete,
    and after one that is cancelled, every table is there. Raises OSError that says what to do.
    """
    source, chosen = tables.folder(), _chosen()
    if chosen is not None and not chosen.is_dir():
        raise NotADirectoryError(f"{chosen}: there is no such folder; choose another in the preferences, or none")
    target = chosen or settings.granted_folder("luts", create=True)
    if target is None or target == source:
        return
    bake.require_writable(target)
    tables.use_folder(target)
    for name, table in tables.TABLES.items():
        original = source / table.path.name
        if original.exists() and (problem([name]) if chosen is None else not table.path.exists()):
            with files.replacing(table.path) as beside:
                shutil.copyfile(original, beside)
    tables.forget()


def delete_own():
    """Delete the tables that were baked here, and use the others. Raises OSError."""
    folder = own_tables()
    for path in folder.glob("*.exr") if folder else ():
        path.unlink(missing_ok=True)
    choose_folder()


def problem(names):
    """What is wrong with the first unusable table of `names`, in words; None when all can be read.

    Panels ask this at every redraw, so an answer is kept until a file changes.
    """
    for name in names:
        found = problem_of(name, tables.TABLES[name].path, lambda name=name: tables.in_use(name))
        if found:
            return found
    return None


def problem_of(name, path, check=None):
    """What is wrong with the file `path` as the table `name`, in words; None when it can be read."""
    try:
        state = path.stat()
        key = (name, path, state.st_mtime_ns, state.st_size)
    except OSError:
        key = (name, path, None, None)
    if key not in _problems:
        try:
            check() if check else tables.check_file(name, path)
            _problems[key] = None
        except tables.TableError as error:
            _problems[key] = str(error)
    return _problems[key]


def stop():
    """Go back to the packaged tables."""
    global folder_problem
    folder_problem = None
    _problems.clear()
    tables.use_folder()
