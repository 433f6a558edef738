"""The user guide's table of messages: each is one that the extension says."""
import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
GUIDE = ROOT / "docs" / "user-guide.md"
GAP = "…"  # in the guide and here, what a message is filled with


def strings(path):
    """All texts in a module, with GAP for each value that is put in."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    inside = {id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in node.values}
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            yield "".join(part.value if isinstance(part, ast.Constant) else GAP for part in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in inside:
            yield node.value


def messages():
    """Every message, in italics, in the first column of the guide's table."""
    table = GUIDE.read_text(encoding="utf-8").partition("## Troubleshooting")[2]
    rows = [line.split(" | ")[0] for line in table.splitlines() if line.startswith("| ")][1:]
    return [message for row in rows for message in re.findall(r"\*([^*]+)\*", row)]


@pytest.fixture(scope="module")
def said():
    return [text for path in sorted((ROOT / "addon").rglob("*.py")) for text in strings(path)]


def is_said(message, said):
    """Whether one text holds the message's pieces between gaps, in their order."""
    pieces = [re.escape(piece.strip()) for piece in message.split(GAP) if piece.strip(" :.")]
    return any(re.search(".*".join(pieces), text, re.DOTALL) for text in said)


def test_messages_are_those_that_are_said(said):
    found = messages()
    assert len(found) > 25
    assert [message for message in found if not is_said(message, said)] == []


def test_another_message_is_not(said):
    assert is_said("Blender … is too old: this needs 4.2 or later", said)
    assert not is_said("Blender … is too old: this needs 4.3 or later", said)
    assert not is_said("later … is too old", said)
