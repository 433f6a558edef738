"""Albedos read from the tables, as renderers read them: fast for any exponent, within 1e-3 between a table's nodes."""
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


TABULATED = TabulatedAlbedos()
