"""Tilted touches, each where the map expects to learn most, until the hole's place is known.

Source: section 3.5 of the study of insertion by touch.
"""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cellctl.processes.peg_in_hole.plan.choice import SearchName
from cellctl.processes.peg_in_hole.search.probe import Felt, TouchProbe
from cellctl.processes.peg_in_hole.search.strategy import SearchStrategy
from cellctl.processes.peg_in_hole.search.tilted_touch import leaning, tilted_dip_m

Array = NDArray[np.float64]

_TOWARDS = np.array([1.0, 0.0])
_DIP_SIGMA_M = 0.08e-3
"""Standard deviation of a dip about what the map expects (section 3.5)."""
_OUTLIER = 0.003
"""Likelihood that is left to a place that a touch speaks against: a touch may be wrong."""
_KNOWN_M = 0.12e-3
"""Standard deviation of the place at which a local spiral takes over: its radius is twice that."""
_MOST_TOUCHES, _ROUNDS = 16, 4
"""Touches of one round, and rounds. Simulated, 9 to 16 touches found the hole (section 3.3)."""
_PARTICLES = 500
"""Places that stand for the belief while the next touch is chosen: enough for a stable choice."""
_PLACES = 15
"""Places for the next touch, along each side of the map."""


class ParticleMap(SearchStrategy):
    """Search for tight holes in a plate, where a valley cannot be followed."""

    name: ClassVar[SearchName] = SearchName.PARTICLE_MAP

    async def find(self, probe: TouchProbe) -> bool:
        """Rounds of touches; what a local spiral did not find is ruled out for the next round."""
        for _ in range(_ROUNDS):
            await self._locate(probe)
            if await probe.look_round(probe.hole_map.mean_m()):
                return True
            probe.hole_map.rule_out(probe.hole_map.mean_m()[None, :])
        return False

    async def _locate(self, probe: TouchProbe) -> None:
        tilt_rad = probe.parameters.tilt.value
        flat_m = -probe.task.fit.peg_radius_m * np.sin(tilt_rad)
        rotation = leaning(_TOWARDS, tilt_rad)
        for _ in range(_MOST_TOUCHES):
            at_m = _most_telling(probe)
            sample = await probe.touch_down(at_m, rotation, flat_m)
            dip_m = float(sample.task_position_tip_m[2]) - flat_m
            dipped = dip_m > probe.parameters.dip_threshold.value
            probe.trace.note(sample, Felt.DIP if dipped else Felt.FACE)
            expected = _dips(probe, at_m - probe.hole_map.points_m)
            likelihood = np.exp(-0.5 * ((dip_m - expected) / _DIP_SIGMA_M) ** 2) + _OUTLIER
            probe.hole_map.weigh(likelihood)
            if probe.hole_map.spread_m() < _KNOWN_M:
                return


def _most_telling(probe: TouchProbe) -> Array:
    """The place (2,) whose dip differs most over what is believed."""
    belief = probe.hole_map
    # Evenly through the belief, heaviest cells first: the same search each time it is run.
    order = np.argsort(belief.weights, axis=None)[::-1]
    total = np.cumsum(belief.weights.flat[order])
    chosen = np.searchsorted(total, (np.arange(_PARTICLES) + 0.5) / _PARTICLES * total[-1])
    particles = belief.points_m.reshape(-1, 2)[order[chosen]]
    reach_m = 2 * belief.spread_m() + probe.task.fit.peg_radius_m / 2
    side = np.linspace(-reach_m, reach_m, _PLACES)
    behind_m = belief.mean_m() - probe.task.fit.peg_radius_m * _TOWARDS
    places = behind_m + np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    spread = np.std(_dips(probe, places[:, None, :] - particles[None, :, :]), axis=1)
    return np.asarray(places[int(np.argmax(spread))])


def _dips(probe: TouchProbe, offsets: Array) -> Array:
    fit = probe.task.fit
    tilt_rad = probe.parameters.tilt.value
    return tilted_dip_m(offsets, _TOWARDS, fit.peg_radius_m, fit.clearance_m, tilt_rad)
