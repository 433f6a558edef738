"""The manual as one HTML page, which ships in the extension: a browser opens it from the disk, without a network.

Its chapters are the Markdown pages, one after the other; links between them lead to chapters, pictures lie beside.
"""
import hashlib
import html
import os
import re
from pathlib import Path

from ...forms.files import replace_text
from ...models import MODELS
from .write import DOCS

MANUAL = DOCS / "manual.html"
GALLERY = "gallery"  # a folder of pictures that does not ship
_FIRST = ("user-guide.md", "models/README.md", *(f"models/{name}.md" for name in MODELS), "technical-directors.md",
          "researchers.md")
_LAST = "../README.md"
_STAMP = "<!-- made by `plausible docs` of pages whose digest is {} -->"
_STYLE = """
:root { color-scheme: light dark; --line: #8885; --code: #8882; }
body { font: 16px/1.55 system-ui, sans-serif; margin: 0; display: flex; }
nav { flex: 0 0 15em; height: 100vh; overflow: auto; position: sticky; top: 0; padding: 1.5em; box-sizing: border-box;
  border-right: 1px solid var(--line); font-size: 14px; }
nav ul { list-style: none; padding-left: 0; margin: 0; } nav li li { padding-left: 1em; }
main { min-width: 0; max-width: 54em; padding: 0 2.5em 6em; overflow-wrap: break-word; }
section { border-top: 1px solid var(--line); margin-top: 3em; }
img { max-width: 100%; } pre, code { background: var(--code); border-radius: 3px; }
code { font-size: 0.9em; padding: 0.1em 0.25em; } pre { padding: 0.8em; overflow: auto; } pre code { padding: 0; }
pre code { background: none; } td code { white-space: nowrap; }
table { border-collapse: collapse; display: block; overflow: auto; }
th, td { border: 1px solid var(--line); padding: 0.3em 0.6em; text-align: left; vertical-align: top; }
th:empty { display: none; }
"""


def pages(docs: Path = DOCS) -> list:
    """Paths of the pages in the order of the manual: a guide, the models, who else it is for, and the README."""
    known = [docs / name for name in (*_FIRST, _LAST)]
    others = [path for path in sorted(docs.glob("*.md")) if path not in known and path.name != "README.md"]
    return [*known[:-1], *others, known[-1]]


def digest(docs: Path = DOCS) -> str:
    """A digest of the pages and the style: equal digests mean equal manuals, whatever the converter's version."""
    texts = [path.read_text(encoding="utf-8") for path in pages(docs)]
    return hashlib.sha256("\0".join([_STYLE, *texts]).encode()).hexdigest()


def is_outdated(path: Path = MANUAL) -> bool:
    """Whether the manual at `path` is missing or not made of the pages in its folder as they are."""
    return not path.is_file() or _STAMP.format(digest(path.parent)) not in path.read_text(encoding="utf-8")


def write(path: Path = MANUAL) -> Path:
    """Write the manual of the pages in its folder; returns its path. Needs the package `markdown`."""
    docs = path.parent
    chapters = [(_name(page, docs), *_chapter(page, docs)) for page in pages(docs)]
    entries = "\n".join(f'<li><a href="#{name}">{html.escape(title)}</a></li>' for name, title, _ in chapters)
    body = "\n".join(f'<section id="{name}">\n{text}\n</section>' for name, _, text in chapters)
    replace_text(path, f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Plausible BRDF: the manual</title>
{_STAMP.format(digest(docs))}
<style>{_STYLE}</style>
</head>
<body>
<nav><ul>
{entries}
</ul></nav>
<main>
{body}
</main>
</body>
</html>
""")
    return path


def _name(page, docs):
    """A chapter's name in links."""
    if page.resolve() == (docs / _LAST).resolve():
        return "about"
    name = page.resolve().relative_to(docs.resolve()).with_suffix("").as_posix()
    return name.replace("/README", "").replace("/", "-")


def _chapter(page, docs):
    """Title and HTML of a page, with links to chapters in place of links to pages."""
    import markdown

    text = page.read_text(encoding="utf-8")
    text = re.sub(rf"^!\[[^\]]*\]\([^)]*\b{GALLERY}/[^)]*\)(\n\n\*.*?\*$)?", "", text, flags=re.MULTILINE | re.DOTALL)
    name = _name(page, docs)

    def anchor(heading, separator):
        # As repository pages name headings; a chapter's come after its name, for there is one page.
        return f"{name}--" + re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", separator)

    converter = markdown.Markdown(extensions=["tables", "fenced_code", "toc", "sane_lists"],
                                  extension_configs={"toc": {"slugify": anchor}})
    converted = converter.convert(text)
    title = re.search(r"^#\s+(.+)$", text, re.MULTILINE)[1]
    return title, re.sub(r'(href|src)="([^"]+)"', lambda match: f'{match[1]}="{_target(match[2], page, docs)}"',
                         converted)


def _target(target, page, docs):
    """The manual's target for a link of a page."""
    if re.match(r"[a-z][a-z0-9+.-]*:", target):
        return target
    path, _, anchor = target.partition("#")
    there = (page.parent / path).resolve() if path else page.resolve()
    if there == docs.resolve() / "README.md":
        return "#"
    if there.suffix == ".md":
        name = _name(there, docs)
        return f"#{name}--{anchor}" if anchor else f"#{name}"
    return Path(os.path.relpath(there, docs.resolve())).as_posix()
