"""Albedos read from the tables, as renderers read them: fast for any exponent, within 1e-3 between a table's nodes."""
from ...models.disk_model import DiskModel
from ...models.lobe_model import LobeModel
from . import tables


class TabulatedAlbedos:
    """The other kind of what albedos.py describes. It raises TableError as `tables.albedos` and `tables.volumes`."""

    def stages(self, lobe, control, cos_theta, exponent, count):
        """See `Albedos`."""
        return tables.albedos(lobe.id, control, cos_theta, exponent)[..., :count]

    def kinks(self, lobe, control, exponent, pumps):
        """None that matter: what is read bends at every column."""
        return ()

    def volumes(self, mu_view, exponent, radius):
        """See `Albedos`."""
        return tables.volumes(mu_view, exponent, radius)


def tables_of(model) -> tuple:
    """Names of the tables for what a model divides by: albedos, or volumes of lumps; () where it divides by nothing."""
    ids = {parameter.id for parameter in model.parameters}
    if isinstance(model, LobeModel) and model.correction == "pumped":
        return tuple(f"{model.lobe.id}_{kind}" for kind in ("plain", "controlled")[:1 + ("control" in ids)])
    if isinstance(model, DiskModel) and "renormalize" in ids:
        return (tables.VolumeTable.name,)
    return ()


def readings(model, p: dict) -> list:
    """[(name of a table, exponent that it is read at)] of a model with resolved parameters."""
    if isinstance(model, DiskModel):
        return [(name, p[rule.exponent]) for name in tables_of(model) if p["renormalize"] for rule in model.lumps]
    if not tables_of(model) or p["pumps"] == 0.0:
        return []
    return [(f"{model.lobe.id}_{'controlled' if p.get('control') else 'plain'}", p["exponent"])]


TABULATED = TabulatedAlbedos()
