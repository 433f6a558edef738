"""Links, pictures and headings of Markdown pages, and the links that are broken."""
import re
from pathlib import Path
from urllib.parse import unquote

_FENCED = re.compile(r"^(```|~~~).*?^\1", re.MULTILINE | re.DOTALL)
_CODE = re.compile(r"`[^`\n]+`")
_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_LINK = re.compile(r"\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")  # also of a picture that is a link
_HTML = re.compile(r"<(?:img|a)\s[^>]*?(?:src|href)=\"([^\"]+)\"")
_HEADING = re.compile(r"^#{1,6}\s+(.+?)\s*#*$", re.MULTILINE)
_OUTSIDE = re.compile(r"[a-z][a-z0-9+.-]*:", re.IGNORECASE)


def targets(text: str) -> list:
    """Targets of links and pictures in a Markdown `text`, in Markdown and HTML, without code and outside addresses."""
    prose = _CODE.sub("", _COMMENT.sub("", _FENCED.sub("", text)))
    found = _LINK.findall(prose) + _HTML.findall(prose)
    return [target for target in found if not _OUTSIDE.match(target)]


def anchors(text: str) -> set:
    """Names of the headings of a Markdown `text`, as repository pages link to them."""
    headings = _HEADING.findall(_FENCED.sub("", text))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken(path: Path) -> list:
    """The targets in the Markdown file at `path` that lead to no file or folder, or to no heading of a page."""
    text = path.read_text(encoding="utf-8")
    return [target for target in targets(text) if not _is_there(path, unquote(target))]


def _is_there(path, target):
    name, _, anchor = target.partition("#")
    there = path.parent / name if name else path
    if not there.exists():
        return False
    return not anchor or (there.suffix == ".md" and anchor in anchors(there.read_text(encoding="utf-8")))
