"""The layout of lobe rows: the views of the rows, and the number of a residual's cells."""
from dataclasses import dataclass, replace

import numpy as np

STEEPEST = np.radians(89.5)  # view angle of the last row
CROWDED = 1.5  # power of the spacing of rows: above 1 they are denser towards grazing


@dataclass(frozen=True)
class Layout:
    """Rows for `views` angles from the normal, at each of `azimuths` azimuths from the tangent.

    One azimuth is for formulas that are round about the normal: half vectors on one side of the plane of incidence are
    enough. Azimuths from 0 to 90 degrees are for formulas that are their own mirror images about both axes. All others
    need azimuths over the `whole` turn.

    A view slice has `turns` directions around the normal, and its residual has `cell_rings` times `cell_turns` cells.
    Rings are ellipses of half vectors: the ring of size s, 0..1/min(`stretch`), has the half axes s times `stretch`.
    """

    views: int
    azimuths: int
    turns: int
    cell_rings: int
    cell_turns: int
    stretch: tuple = (1.0, 1.0)
    whole: bool = False

    @property
    def rows(self) -> int:
        """Number of rows. They are in order of azimuths, and of angles from the normal for each azimuth."""
        return self.azimuths * self.views

    @property
    def around(self) -> float:
        """Range of azimuths of a view slice's half vectors in radians: pi where the formula is round, else 2 pi."""
        return np.pi if self.azimuths == 1 else 2.0 * np.pi

    def view_angles(self) -> np.ndarray:
        """Angles from the normal of the rows of one azimuth, in radians, (views,)."""
        return self.angle_at(np.arange(self.views))

    def angle_at(self, position):
        """Angle from the normal in radians at the `position` of a row, 0 .. views - 1, or between two."""
        return STEEPEST * (1.0 - (1.0 - position / (self.views - 1)) ** CROWDED)

    def view_directions(self) -> np.ndarray:
        """Unit vectors to the rows' views, (rows, 3)."""
        turn = 2.0 * np.pi if self.whole else 0.5 * np.pi
        theta, phi = self.view_angles(), np.linspace(0.0, turn, self.azimuths, endpoint=not self.whole)[:, None]
        x, y, z = np.broadcast_arrays(np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta))
        return np.stack([x, y, z], axis=-1).reshape(-1, 3)


ROUND = Layout(views=48, azimuths=1, turns=40, cell_rings=20, cell_turns=24)
STRETCHED = Layout(views=24, azimuths=5, turns=64, cell_rings=16, cell_turns=24)
# Layouts for lobes of any shape, which need small cells, and change little from view to view.
PAINTED = Layout(views=12, azimuths=4, turns=96, cell_rings=32, cell_turns=48)
PAINTED_WHOLE = Layout(views=10, azimuths=12, turns=96, cell_rings=22, cell_turns=30, whole=True)


def layout_of(model, p: dict, common: Layout | None = None) -> Layout:
    """The layout of a model for resolved parameters `p`. With `common` it is that layout with the stretch for `p`."""
    if model.mirrored:
        return common or (PAINTED if model.mirrored(p) else PAINTED_WHOLE)
    stretch = model.stretched(p) if model.stretched else (1.0, 1.0)
    return replace(common or (ROUND if stretch[0] == stretch[1] else STRETCHED), stretch=stretch)


def common_layout(model, several) -> Layout:
    """A layout for rows of all of `several` resolved parameters: the one with most azimuths."""
    return max((layout_of(model, p) for p in several), key=lambda layout: layout.azimuths)
