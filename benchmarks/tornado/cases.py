"""Which imperfections are tried at which size, and where."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from fakes.imperfections import CATALOGUE

NONE, ALL = "none", "all"
"""Cases that are no single imperfection: the reference, and all together."""
MATING_ONLY = frozenset(
    {
        "latency_jitter", "stop_jitter", "burr", "sensor_crosstalk", "sensor_noise", "sensor_hum",
        "sensor_drift", "sensor_nonlinearity", "sensor_hysteresis", "sensor_lag",
    }
)  # fmt: skip
"""Nothing of them reaches a picture."""
SCALES = (1.0, 2.0, 5.0)
"""Times the realistic size of each."""
Place = Literal["cell", "mating"]


@dataclass(frozen=True, slots=True, order=True)
class Case:
    """One run."""

    imperfection: str
    """Name in the catalogue, ``NONE`` or ``ALL``."""
    scale: float
    place: Place
    seed: int

    @property
    def key(self) -> str:
        """Tells it from all others, in files and folders."""
        return f"{self.imperfection}-{self.scale:g}-{self.place}-{self.seed}"

    def scales(self) -> dict[str, float]:
        """Scale of every imperfection of the scenario.

        What the scenario file gives a size stays at that size in every case. All together leaves
        out what would need other calibrations.
        """
        scales = {name: 0.0 for name, one in CATALOGUE.items() if not one.keys}
        if self.imperfection == ALL:
            scales |= {name: self.scale for name, one in CATALOGUE.items() if not one.calibrated}
        elif self.imperfection != NONE:
            scales[self.imperfection] = self.scale
        return scales


def cases(
    scales: Sequence[float], seeds: Sequence[int], only: Sequence[str] = ()
) -> Iterator[Case]:
    """All runs of a campaign, the references first; ``only`` names some imperfections.

    A reference is run where at least one of the imperfections is tried.
    """
    tried = [name for name in (*sorted(CATALOGUE), ALL) if not only or name in only]
    for place in sorted({_place(name) for name in tried}, reverse=True):
        yield from (Case(NONE, 0.0, place, seed) for seed in seeds)
    for name in tried:
        for scale in scales:
            # The reference has the sizes of the scenario file.
            if scale == 1 and name in CATALOGUE and CATALOGUE[name].keys:
                continue
            yield from (Case(name, scale, _place(name), seed) for seed in seeds)


def _place(imperfection: str) -> Place:
    return "mating" if imperfection in MATING_ONLY else "cell"
