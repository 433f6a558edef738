"""The manual's pages: those made from the registry are today's, say what is declared, and no link leads nowhere."""
import os
import re
from dataclasses import replace
from pathlib import Path

import pytest

from addon import cli
from addon.backends.osl import estimator
from addon.brdf import MODELS
from addon.dev.packaging import archive
from addon.dev.pages import figure_values, limits, links, manual, model_page, write
from addon.forms.albedo import tabulated
from addon.library import presets

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
TODAY = "run `plausible docs`"


@pytest.fixture(scope="module")
def texts():
    return write.texts()


def test_every_model_has_todays_page(texts):
    there = {path.name: path.read_text(encoding="utf-8") for path in write.MODEL_PAGES.glob("*.md")}
    assert there.keys() == texts.keys() == {"README.md", *(f"{name}.md" for name in MODELS)}, TODAY
    assert [name for name in texts if there[name] != texts[name]] == [], TODAY


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_links_and_pictures_are_there(path):
    assert links.broken(path) == []


def test_the_manual_is_of_todays_pages():
    assert not manual.is_outdated(), TODAY


def test_the_manual_leads_somewhere():
    """As the extension has it: pictures and files that ship, and chapters and headings that are there."""
    text = manual.MANUAL.read_text(encoding="utf-8")
    shipped, places = set(archive.files()), set(re.findall(r'id="([^"]+)"', text))
    found = re.findall(r'(?:href|src)="([^"]+)"', text)
    assert len(found) > 250 and {"#models-ward", "models/ward.png", "panel.png"} <= set(found)
    inside = {target[1:] for target in found if target.startswith("#")} - {""}
    assert inside - places == set()
    paths = {target.partition("#")[0] for target in found if not re.match("#|[a-z]+:", target)}
    lost = {path for path in paths if os.path.normpath(f"docs/{path}") not in shipped}
    assert lost == {path for path in lost if re.match(r"\.\./(tests|demo_blends|run)", path)}


def test_a_changed_page_makes_the_manual_outdated(tmp_path):
    (tmp_path / "models").mkdir()
    for page in manual.pages():
        name = os.path.relpath(page, manual.DOCS)
        if not name.startswith(".."):
            (tmp_path / name).write_text(f"# {name}\n\n[on](user-guide.md#there)\n", encoding="utf-8")
    folder = tmp_path / "docs"
    (tmp_path / "README.md").write_text("# All\n\n![Gone](docs/gallery/a.png)\n\n*Words.*\n\nLast\n", encoding="utf-8")
    folder.mkdir()
    for entry in ("models", *(path.name for path in tmp_path.glob("*.md") if path.name != "README.md")):
        (tmp_path / entry).rename(folder / entry)
    written = manual.write(folder / "manual.html")
    text = written.read_text(encoding="utf-8")
    assert 'href="#user-guide--there"' in text and "Last" in text and "Words" not in text and "gallery" not in text
    assert not manual.is_outdated(written)
    (folder / "researchers.md").write_text("# Changed\n", encoding="utf-8")
    assert manual.is_outdated(written)


def test_pictures_are_small():
    sizes = {path.name: path.stat().st_size for path in write.MODEL_PAGES.glob("*.png")}
    assert sizes.keys() == {f"{name}.png" for name in MODELS}
    assert max(sizes.values()) < 60e3


def test_a_page_says_what_is_declared(texts):
    for model in MODELS.values():
        text = texts[model_page.file_name(model)]
        for words in (model.label, model.description, model.formula, *model.references):
            assert words in text
        for parameter in model.parameters:
            row = next(line for line in text.splitlines() if f"| `{parameter.id}` |" in line)
            assert parameter.help.replace("|", "\\|") in row and row.startswith(f"| {parameter.label} |")
        assert ("It is baked" in text) == estimator.is_baked(model)
        assert all(f"`{name}`" in text for name in tabulated.tables_of(model))
        mine = [preset.label for preset in presets.PRESETS.values() if preset.model == model.id]
        assert all(f"**{label}**" in text for label in mine) and ("## Presets" in text) == bool(mine)
        assert texts["README.md"].count(f"[{model.label}]({model.id}.md)") == 1


def test_properties_in_words(texts):
    """What is known of the formulas: DESIGN's check value 1.0607 at n = 20, and which are reciprocal."""
    assert "| Conserves energy | no: the largest albedo is 1.061, at 0° |" in texts["blinn.md"]
    assert "| Conserves energy | yes: the largest albedo is 1.000, at 0° |" in texts["pumped_phong.md"]
    for name in ("phong", "ward", "reciprocal_disk", "pumped_ward"):
        assert "| Reciprocal | yes |" in texts[f"{name}.md"]
    for name in ("disk_scaling", "kajiya_kay"):
        assert "| Reciprocal | no: f(V, L) and f(L, V) differ by up to" in texts[f"{name}.md"]


def test_a_changed_declaration_is_seen():
    phong = MODELS["phong"]
    changed = replace(phong, parameters=(replace(phong.parameters[0], default=21.0), *phong.parameters[1:]))
    before, after = (model_page._parameters(model).splitlines() for model in (phong, changed))
    assert [(a, b) for a, b in zip(before, after, strict=True) if a != b] == [(before[2], after[2])]
    assert "| 20 |" in before[2] and "| 21 |" in after[2]


def test_shown_values_are_allowed():
    for model in MODELS.values():
        settings = figure_values.shown(model).settings()
        assert len({tuple(given.items()) for given in settings}) == 3
        for given in settings:
            model.resolve(given)


def test_limits_are_readmes():
    text = "# Name\n\n## Limits\n\n- Cycles only.\n- " + "\n- ".join(f"{b} one\n  and two." for b in limits._ABOUT)
    assert limits.entries(text)[:2] == ["Cycles only.", "A lamp of no size one and two."]
    assert limits.limits_of(MODELS["ndf_map"], text) == ["Models that are baked one and two.", "NDF maps one and two."]
    for wrong in (text.replace("NDF maps", "Maps"), text + "\n- NDF maps again."):
        with pytest.raises(ValueError, match=r"'NDF maps'.*addon/dev/pages/limits\.py"):
            limits.limits_of(MODELS["phong"], wrong)
    with pytest.raises(ValueError, match="no list under '## Limits'"):
        limits.entries("# Name\n")


def test_links_are_found(tmp_path):
    (tmp_path / "other.md").write_text("# Two Words, and `code`\n\n```sh\n# no heading\n```\n", encoding="utf-8")
    (tmp_path / "there.png").touch()
    page = tmp_path / "page.md"
    page.write_text("""# Top
[a](other.md) [b](other.md#two-words-and-code) [c](#top) ![d](there.png) <img src="there.png"> [e](https://a.org/x)
`[code](no.md)` <!-- [comment](no.md) -->
```
[fenced](no.md)
```
[w](missing.md) [![x](missing.png)](other.md) [y](other.md#no-heading) <img width="3" src="gone.png"> [z](#nowhere)
""", encoding="utf-8")
    assert sorted(links.broken(page)) == ["#nowhere", "gone.png", "missing.md", "missing.png", "other.md#no-heading"]


def test_command(tmp_path, capsys, monkeypatch, texts):
    monkeypatch.setattr(write, "texts", lambda: texts)
    assert cli.main(["docs", "--output", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == set(texts)
    assert cli.main(["docs", "--check", "--output", str(tmp_path)]) == 0
    (tmp_path / "phong.md").write_text("old", encoding="utf-8")
    (tmp_path / "gone.md").touch()
    assert write.outdated(tmp_path) == ["gone.md", "phong.md"]
    capsys.readouterr()
    assert cli.main(["docs", "--check", "--output", str(tmp_path)]) == 1
    assert "phong.md is not what `plausible docs` writes" in capsys.readouterr().out
    assert cli.main(["docs", "phong"]) == 2 and "--pictures" in capsys.readouterr().err
    assert cli.main(["docs", "--pictures", "nonsense"]) == 2
