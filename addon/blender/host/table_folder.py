"""The folder of albedo tables inside Blender, and its problems."""
import shutil
from pathlib import Path

from ...forms import files
from ...forms.albedo import bake, tables
from . import settings

# Why the user's folder, or the tables baked on this computer, are not used; None where they are, or there are none.
folder_problem = None
_problems = {}  # (table, path, time of modification in ns, size in bytes) -> its problem or None


def choose_folder():
    """Use the user's folder, else the tables that were baked on this computer, else the shipped ones.

    A folder with a missing table, or with one of another version, is not used; `folder_problem` gives the reason.
    """
    global folder_problem
    folder_problem = None
    # The first folder without a problem is used; the first problem is reported.
    candidates = [folder for folder in (_user_folder(), own_tables()) if folder is not None]
    for folder in candidates:
        defect = _try_folder(folder)
        if defect is None:
            return
        folder_problem = folder_problem or defect
    tables.use_folder()
    if folder_problem:
        folder_problem += ". The shipped tables are used"


def start():
    """Choose the folder of tables."""
    choose_folder()


def _user_folder():
    """The folder in the preferences, or None."""
    path = settings.lut_folder()
    return Path(path) if path else None


def own_tables():
    """The folder of tables that were baked on this computer, or None where it has none."""
    folder = settings.granted_folder("luts")
    return folder if folder is not None and any(folder.glob("*.exr")) else None


def _try_folder(folder):
    """Use a folder. Returns a sentence on its problem, or None."""
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
    """Use the folder that a bake writes to: the user's folder, else the extension's own, else the folder in use.

    Missing tables are copied into it, and unusable ones are replaced in the extension's own folder. So the folder is
    complete during a bake, and after a canceled one. Raises OSError, whose message gives a remedy.
    """
    source, user_folder = tables.folder(), _user_folder()
    if user_folder is not None and not user_folder.is_dir():
        raise NotADirectoryError(f"{user_folder}: there is no such folder; choose another in the preferences, or none")
    target = user_folder or settings.granted_folder("luts", create=True)
    if target is None or target == source:
        return
    # Copy the tables that the folder lacks.
    bake.require_writable(target)
    tables.use_folder(target)
    for name, table in tables.TABLES.items():
        original = source / table.path.name
        if original.exists() and (problem([name]) if user_folder is None else not table.path.exists()):
            with files.replacing(table.path) as temporary:
                shutil.copyfile(original, temporary)
    tables.forget()


def delete_own():
    """Delete the tables that were baked on this computer, and choose the folder anew.

    Raises OSError where a file cannot be deleted.
    """
    folder = own_tables()
    for path in folder.glob("*.exr") if folder else ():
        path.unlink(missing_ok=True)
    choose_folder()


def problem(names):
    """A sentence on the problem of the first unusable table of `names`; None where all are usable.

    Panels call this at every redraw, so results are cached until a file changes.
    """
    for name in names:
        text = problem_of(name, tables.TABLES[name].path, lambda name=name: tables.in_use(name))
        if text:
            return text
    return None


def problem_of(name, path, check=None):
    """A sentence on the problem of the file `path` as the table `name`; None where it is usable.

    `check()` raises TableError for an unusable table; None stands for `tables.check_file`.
    """
    # The file's time and size are part of the cache's key.
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
    """Use the shipped tables again."""
    global folder_problem
    folder_problem = None
    _problems.clear()
    tables.use_folder()
