"""Albedos read from the tables, as renderers read them: fast for any exponent, with errors up to 1e-3 between nodes."""
from ...models.disk_model import DiskModel
from ...models.lobe_model import LobeModel
from . import tables


class TabulatedAlbedos:
    """`Albedos` (addon/models/albedos.py) from the tables. Raises TableError as `tables.albedos`, `tables.volumes`."""

    def stages(self, lobe, control, cos_theta, exponent, count):
        """See `Albedos`."""
        return tables.albedos(lobe.id, control, cos_theta, exponent)[..., :count]

    def kinks(self, lobe, control, exponent, pumps):
        """(): the linear interpolation has a kink at every column, and the formula's own kinks do not matter."""
        return ()

    def volumes(self, mu_view, exponent, radius):
        """See `Albedos`."""
        return tables.volumes(mu_view, exponent, radius)


def tables_of(model) -> tuple:
    """Names of the tables that a model reads, of albedos or volumes that it divides by; () of a model without any.

    Of a pumped lobe: the plain table, and then the controlled one if it has a `control`.
    """
    ids = {parameter.id for parameter in model.parameters}
    if isinstance(model, LobeModel) and model.correction == "pumped":
        return tuple(f"{model.lobe.id}_{kind}" for kind in ("plain", "controlled")[:1 + ("control" in ids)])
    if isinstance(model, DiskModel) and "renormalize" in ids:
        return (tables.VolumeTable.name,)
    return ()


def readings(model, p: dict) -> list:
    """[(name of a table, exponent of the reading)] of a model with the resolved parameters `p`."""
    names = tables_of(model)
    if isinstance(model, DiskModel):
        return [(name, p[rule.exponent]) for name in names if p["renormalize"] for rule in model.lumps]
    if not names or p["pumps"] == 0.0:
        return []
    return [(names[bool(p.get("control"))], p["exponent"])]


TABULATED = TabulatedAlbedos()
