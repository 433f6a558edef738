"""Translation of the interface.

Blender itself translates names and tooltips of properties, operators and panels. `tr` translates sentences with values
in them. A language is one module with a table from English to that language, as german.py; values are named in braces.
"""
import bpy

from .german import GERMAN

LANGUAGES = {"de_DE": GERMAN}
# Blender's translation contexts: the default, and that of operators' names.
_CONTEXTS = ("*", "Operator")


def translate(text: str) -> str:
    """`text` in the language of the interface, or unchanged where there is no translation."""
    return bpy.app.translations.pgettext_iface(text)


def tr(text: str, **values) -> str:
    """`text` in the language of the interface, its {names} filled in with `values`."""
    return translate(text).format(**values)


def start():
    """Register the translations with Blender."""
    tables = {language: {(context, english): word for english, word in words.items() for context in _CONTEXTS}
              for language, words in LANGUAGES.items()}
    bpy.app.translations.register(__package__, tables)


def stop():
    """Unregister the translations."""
    bpy.app.translations.unregister(__package__)
