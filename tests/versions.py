"""What came out of the tests in each version of Blender: a line for each, and the table docs/versions.md.

    python tests/versions.py RESULTS [TABLE]

prints the lines of the file RESULTS, one JSON object a line as conftest.py adds them, and puts those of whole suites
into the Markdown file TABLE, in place of older ones of the same version.
"""
import json
import re
import sys
from importlib import metadata
from pathlib import Path

COLUMNS = ("blender", "python", "tests", "passed", "skipped", "minutes", "date")
WHOLE = ("", "not proof")  # selections that are the whole suite
HEAD = """# Tests in each version of Blender

The whole suite, headless, in Blender as a Python module; `./run versions` runs it and writes this table. Statistics
with a million samples, which are about formulas and samplers and not about Blender, run in 5.2 alone. Minutes are those
of one machine of two cores.

| Blender | Python | Tests | Passed | Skipped | Minutes | Date |
|---|---|---|---|---|---|---|
"""


def result(outcomes: dict, selection: str, seconds: float, date: str) -> dict:
    """One run of the tests: `outcomes` are (set of test names) by pytest's words, `selection` is what -m was given."""
    failed = outcomes.get("failed", set()) | outcomes.get("error", set())
    passed = outcomes.get("passed", set()) - failed
    skipped = outcomes.get("skipped", set()) - failed
    return {"blender": blender(), "python": ".".join(map(str, sys.version_info[:2])), "selection": selection,
            "tests": len(failed | passed | skipped), "passed": len(passed), "skipped": len(skipped),
            "minutes": round(seconds / 60.0, 1), "date": date}


def blender() -> str:
    """Version of Blender's module, or "none" where it is not installed."""
    try:
        return metadata.version("bpy")
    except metadata.PackageNotFoundError:
        return "none"


def line(found: dict) -> str:
    """A result in one line."""
    skipped = f", {found['skipped']} skipped" if found["skipped"] else ""
    selection = f" (-m {found['selection']!r})" if found["selection"] else ""
    return (f"Blender {found['blender']:7} Python {found['python']}: {found['passed']} of {found['tests']} tests "
            f"passed{skipped} in {found['minutes']:.1f} minutes{selection}")


def table(text: str, found: list) -> str:
    """The Markdown `text` with rows for what was `found`, sorted by version; others that are in it stay."""
    rows = {match[1]: match[0] for match in re.finditer(r"^\| (\d[\d.]*) \|.*$", text, re.MULTILINE)}
    for new in found:
        series = _series(new["blender"])
        rows = {version: row for version, row in rows.items() if _series(version) != series}
        rows[new["blender"]] = "| " + " | ".join(str(new[column]) for column in COLUMNS) + " |"
    return HEAD + "".join(f"{rows[version]}\n" for version in sorted(rows, key=_numbers))


def _numbers(version):
    return tuple(int(part) for part in version.split("."))


def _series(version):
    return _numbers(version)[:2]


def main(results, path=None):
    found = [json.loads(text) for text in Path(results).read_text(encoding="utf-8").splitlines()]
    print("\n".join(line(one) for one in found) or "no tests were run to their end")
    if path:
        path = Path(path)
        whole = [one for one in found if one["selection"] in WHOLE]
        text = table(path.read_text(encoding="utf-8") if path.exists() else "", whole)
        part = path.with_suffix(".part")
        part.write_text(text, encoding="utf-8")
        part.replace(path)


if __name__ == "__main__":
    main(*sys.argv[1:])
