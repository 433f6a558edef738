"""The interface's words in other languages.

Blender looks names and help of properties, operators and panels up by itself; `tr` looks up sentences that are put
together. A language is one module with a table, as german.py: English to its own, numbers named in braces.
"""
import bpy

from .german import GERMAN

LANGUAGES = {"de_DE": GERMAN}
_CONTEXTS = ("*", "Operator")  # where Blender looks: for operators' names apart


def translate(text: str) -> str:
    """`text` in the language of the interface, or as it is."""
    return bpy.app.translations.pgettext_iface(text)


def tr(text: str, **values) -> str:
    """`text` in the language of the interface, its {names} filled in with `values`."""
    return translate(text).format(**values)


def start():
    """Give Blender the words."""
    tables = {language: {(context, english): word for english, word in words.items() for context in _CONTEXTS}
              for language, words in LANGUAGES.items()}
    bpy.app.translations.register(__package__, tables)


def stop():
    """Take the words back."""
    bpy.app.translations.unregister(__package__)
