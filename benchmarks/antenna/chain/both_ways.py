"""The same plugs with drawn looks and with looks at rendered images."""

from dataclasses import dataclass

import numpy as np

from benchmarks.antenna.chain.arms import FACTORY, RP_002
from benchmarks.antenna.chain.drawn_cell import draw_cell
from benchmarks.antenna.chain.image_optics import with_images
from benchmarks.antenna.chain.trials import PATTERN, Bench, Conditions, believed_cell
from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.chain.schemes import SCHEMES
from cellctl.processes.antenna_module.chain.worst_contact import contact_offsets

CONDITIONS = Conditions(kelvin=3.0, teachings=8, socket_looks=2)


@dataclass(frozen=True, slots=True, eq=False)
class BothWays:
    """Errors of plugs by the difference scheme, shape (n, 3): x, y (m), yaw (rad)."""

    drawn: Array
    images: Array

    @property
    def change_m(self) -> float:
        """Root mean square, per axis, of what images change."""
        return float(np.sqrt(((self.images - self.drawn)[:, :2] ** 2).mean()))

    @property
    def worst_m(self) -> Array:
        """Distance of the worst contact with images, shape (n,)."""
        return np.asarray(contact_offsets(self.images, PATTERN.positions_m).max(axis=1))


def plugs_both_ways(seed: int, plugs: int) -> BothWays:
    """Teach, warm up and plug in the cell of a seed, twice with the same chances."""
    cell = draw_cell(np.random.default_rng([seed, 1]), FACTORY, RP_002)
    believed = believed_cell(cell, FACTORY, CONDITIONS.kelvin)
    scheme = SCHEMES["difference"]
    drawn, images = (
        Bench(one, believed, np.random.default_rng([seed, 5]))
        .run([scheme], CONDITIONS, plugs)
        .errors[scheme.name]
        for one in (cell, with_images(cell, seed))
    )
    return BothWays(drawn, images)


def together(each: list[BothWays]) -> BothWays:
    """All plugs of several cells."""
    return BothWays(
        np.concatenate([one.drawn for one in each]), np.concatenate([one.images for one in each])
    )
