"""The interface in other languages: tables are complete, name nothing that is not shown, and keep numbers in place."""
import string

import pytest
from blender_help import interface_words
from blender_help.recorder import context_for, drawn, texts

pytestmark = [pytest.mark.blender, pytest.mark.versions]


def table():
    from addon.blender.host.german import GERMAN

    return GERMAN


def test_every_name_and_sentence_has_a_word():
    shown = interface_words.labels() | interface_words.sentences()
    assert len(shown) > 100
    assert not sorted(shown - set(table()))


def test_no_word_is_for_what_is_not_shown():
    source = "".join(path.read_text(encoding="utf-8") for path in interface_words.BLENDER.rglob("*.py")
                     if path.name != "german.py")
    flat = source.replace('"\n', "").replace("\n", "")
    shown = interface_words.labels() | interface_words.sentences()
    # Sentences that are chosen from a table stand in the source as they are, perhaps over two lines.
    assert not [text for text in table() if text not in shown and text[:30] not in flat]


def test_numbers_stay():
    def fields(text):
        return sorted(name for _, name, _, _ in string.Formatter().parse(text) if name)

    for english, german in table().items():
        assert fields(english) == fields(german) and german.strip(), english


def test_the_panel_speaks_german(bpy):
    from addon import create_material
    from addon.blender.host import translation

    view = bpy.context.preferences.view
    before = view.language, view.use_translate_interface
    try:
        view.language, view.use_translate_interface = "de_DE", True
    except TypeError:  # a build without languages knows English only
        assert translation.tr("Furnace Test") == "Furnace Test"
        return
    try:
        assert translation.tr("Furnace test, render {done} of {total}", done=2, total=7) == "Ofentest, Bild 2 von 7"
        assert "Materialien rendern schwarz" in texts(drawn(context_for(bpy, create_material("phong"), osl=False)))
    finally:
        view.language, view.use_translate_interface = before
    assert translation.tr("Furnace test, starting") == "Furnace test, starting"
