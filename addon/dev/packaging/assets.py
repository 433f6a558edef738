"""Makes the asset library: a .blend with the presets as materials and the models as nodes, and its catalogs.

Blender reads files of its own and of older versions, so make the shipped file in the oldest supported version.
"""
import uuid
from pathlib import Path

from ...assets import LIBRARY, preview
from ...backends.osl import estimator
from ...forms import files
from ...library.presets import PRESETS
from ...models import MODELS

CATALOGUES = "blender_assets.cats.txt"
_NODES = "Plausible/Nodes"
_SPACE = uuid.UUID("6d3f7c0e-52a1-4f0b-9f0c-6b1de52a4f10")  # arbitrary, but fixed: catalogs keep their ids


def build(folder: Path = LIBRARY.parent, progress=lambda done, total: None) -> Path:
    """Writes the library into `folder`; returns its path. The file that is open in Blender is lost.

    Calls `progress(done, total)` after each material and node. Raises OSError where the folder cannot be written.
    """
    import bpy

    from ...blender.material import groups, materials

    bpy.ops.wm.read_factory_settings(use_empty=True)
    # Other models are baked for each use, so they have no node to share.
    models = [model for model in MODELS.values() if not estimator.is_baked(model)]
    total, made = len(PRESETS) + len(models), set()
    for key, preset in PRESETS.items():
        material = materials.create_material(preset.model, preset.label, **preset.parameters)
        tags = preset.group, MODELS[preset.model].label
        _mark(material, preview(key), preset.help, _catalog(preset), tags)
        made.add(material)
        progress(len(made), total)
    for model in models:
        tree = groups.find_node(materials.create_material(model.id)).node_tree
        _mark(tree, preview(model.id), model.description, _NODES, ("BRDF",))
        made.add(tree)
        progress(len(made), total)
    folder.mkdir(parents=True, exist_ok=True)
    _write_catalogs(folder / CATALOGUES)
    path = folder / LIBRARY.name
    with files.replacing(path) as beside:
        bpy.data.libraries.write(str(beside), made, compress=True)
    return path


def missing_previews() -> list:
    """Ids of the presets and models without a thumbnail."""
    keys = [*PRESETS, *(model.id for model in MODELS.values() if not estimator.is_baked(model))]
    return [key for key in keys if not preview(key).is_file()]


def _catalog(preset):
    """Path of a preset's catalog."""
    return f"Plausible/{preset.group}"


def identifier(catalog: str) -> str:
    """The UUID of a catalog."""
    return str(uuid.uuid5(_SPACE, catalog))


def _mark(block, picture, description, catalog, tags):
    """Marks a data-block as an asset with a thumbnail, a description, a catalog and tags."""
    import bpy

    block.asset_mark()
    data = block.asset_data
    data.description, data.catalog_id = description, identifier(catalog)
    data.author, data.license = "Plausible BRDF contributors", "GPL-3.0-or-later"
    for tag in tags:
        data.tags.new(tag, skip_if_exists=True)
    image = bpy.data.images.load(str(picture))
    preview = block.preview_ensure()
    preview.image_size = image.size
    preview.image_pixels_float.foreach_set(list(image.pixels))
    bpy.data.images.remove(image)


def _write_catalogs(path):
    """Writes Blender's file of catalogs."""
    names = sorted({"Plausible", _NODES, *map(_catalog, PRESETS.values())})
    lines = ["# Catalogues of the Plausible BRDF asset library.", "VERSION 1", ""]
    lines += [f"{identifier(name)}:{name}:{name.replace('/', '-')}" for name in names]
    files.replace_text(path, "\n".join(lines) + "\n")
