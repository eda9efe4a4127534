"""The rows B1 to B6 of the table."""

from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial

import numpy as np

from benchmarks.antenna.vision.report import Report
from cellctl.errors.base import CellError
from cellctl.processes.antenna_module.faults.connector import (
    ConnectorTurned,
    ForeignIntrinsics,
    ImageMirrored,
    LightFromOneSide,
    WrongConnector,
)
from tests.rigs.antenna.outcomes import (
    Outcome,
    both,
    false_alarms,
    quantiles,
    refusal,
    words,
)
from tests.rigs.antenna.pictures import CLEAN, HOLES, POOR, Conditions

WRONG_UM = 10.0
"""A measurement that is farther off is a wrong result: it ought to have been refused."""


class Bench:
    """Images of one seed after another, spread over the processors, and the rows made of them."""

    def __init__(self, pool: ProcessPoolExecutor, count: int) -> None:
        self.pool = pool
        self.count = count
        self.report = Report()
        self.nees: list[float] = []

    def run(
        self, conditions: Conditions, share: float = 1.0
    ) -> tuple[list[Outcome], list[Outcome]]:
        """Outcomes of the default and of the paper's method."""
        seeds = range(max(round(share * self.count), 4))
        pairs = list(self.pool.map(partial(both, conditions=conditions), seeds))
        return [pair[0] for pair in pairs], [pair[1] for pair in pairs]

    def accuracy(
        self,
        number: str,
        what: str,
        conditions: Conditions,
        limits: tuple[float, float],
        *,
        share: float = 1.0,
        refusals: bool = False,
        as_drawn: bool = True,
    ) -> None:
        """B1 and B2: errors of place (µm) and yaw (degrees), 95 of 100 below their limits, and
        no wrong result.

        ``as_drawn``: the contacts look as the drawing says, so that B6 counts these images.
        """
        default, paper = self.run(conditions, share)
        measured = [item for item in default if not item.fault]
        if as_drawn:
            self.nees += [item.nees for item in measured]
        place, yaw = quantiles(measured)
        sound = refusals or len(measured) == len(default)
        good = bool(measured) and sound and place <= limits[0] and yaw <= limits[1]
        good &= all(item.distance_um <= WRONG_UM for item in measured)
        demanded = f"p95 ≤ {limits[0]:g} µm, {limits[1]:g}°; none beyond {WRONG_UM:g} µm"
        self.report.row(
            number,
            what,
            len(default),
            demanded=demanded,
            default=words(default),
            paper=words(paper),
            good=good,
        )

    def missing(self) -> None:
        """B3: a missing contact is named, the pose stays right, the paper's method refuses."""
        default, paper = self.run(replace(CLEAN, missing=1), 0.625)
        named = sum(item.bad == item.faulty for item in default)
        worst = max(item.distance_um for item in default)
        refused = sum(item.fault == "PaperMethodRefused" for item in paper)
        count = len(default)
        self.report.row(
            "B3",
            "one contact missing",
            count,
            demanded="named 100 %, pose ≤ 2 µm; paper refuses",
            default=f"named {named}, worst {worst:.2f} µm",
            paper=f"refused {refused}",
            good=named == refused == count and worst <= 2.0,
        )

    def bent(self) -> None:
        """B4: bent contacts are named; good connectors are not suspected."""
        default, paper = self.run(replace(CLEAN, bent_m=1e-4), 1.25)
        named = sum(item.bad == item.faulty for item in default)
        count = len(default)
        self.report.row(
            "B4",
            "one contact bent by 0.10 mm",
            count,
            demanded="named ≥ 99 %",
            default=f"named {named}, {words(default)}",
            paper=words(paper),
            good=named >= 0.99 * count,
        )
        connectors = 5000
        false = false_alarms(connectors)
        self.report.row(
            "B4",
            "10 µm true position, contacts drawn",
            connectors,
            demanded="false alarms ≤ 1 in 1000",
            default=str(false),
            good=false <= connectors / 1000,
        )

    def refused(self, what: str, conditions: Conditions, fault: type[CellError]) -> None:
        """B2: what must not be measured is refused, with this fault."""
        default, paper = self.run(conditions, 0.25)
        right = sum(item.fault == fault.__name__ for item in default)
        self.report.row(
            "B2",
            what,
            len(default),
            demanded=f"{fault.__name__} 100 %",
            default=f"{right}; {words(default)}",
            paper=words(paper),
            good=right == len(default),
        )

    def blocked(self) -> None:
        """B3: a blocked hole is named; the pose stays within 2 µm beyond the bias of lit walls."""
        default, paper = self.run(replace(HOLES, blocked=1), 0.625)
        measured = [item for item in default if not item.fault]
        named = sum(item.bad == item.faulty for item in measured)
        worst = max(item.distance_um for item in measured)
        self.report.row(
            "B3",
            "one hole blocked",
            len(default),
            demanded="named 100 %, pose ≤ 6 µm",
            default=f"named {named}, worst {worst:.2f} µm",
            paper=words(paper),
            good=named == len(default) and worst <= 6.0,
        )

    def wrong(self) -> None:
        """B5: what must be refused, each with its own fault."""
        wide = replace(CLEAN, marks=True, um_per_px=(35.0, 35.0))
        cases: tuple[tuple[str, Conditions, str, type[CellError]], ...] = (
            ("turned by 180°", replace(CLEAN, turn_deg=180.0), "none", ConnectorTurned),
            (
                "turned by 180° in the gripper",
                replace(wide, turn_deg=180.0),
                "none",
                ConnectorTurned,
            ),
            ("mirrored, with marks", wide, "mirror", ImageMirrored),
            ("upside down and mirrored, with marks", wide, "flip", ImageMirrored),
            ("file of the D-sub", CLEAN, "file", WrongConnector),
            ("image of the D-sub", replace(CLEAN, name="d-sub-15"), "file", WrongConnector),
            ("intrinsics exchanged", CLEAN, "intrinsics", ForeignIntrinsics),
        )
        for what, conditions, change, fault in cases:
            seeds = range(max(round(0.15 * self.count), 4))
            found = list(
                self.pool.map(partial(refusal, conditions=conditions, change=change), seeds)
            )
            right = sum(name == fault.__name__ for name in found)
            others = sorted({name for name in found if name != fault.__name__})
            self.report.row(
                "B5",
                what,
                len(found),
                demanded=f"{fault.__name__} 100 %",
                default=f"{right} {' '.join(others)}",
                good=right == len(found),
            )

    def covariance(self) -> None:
        """B6: errors against stated covariances, over the images of all rows before."""
        if not self.nees:
            return
        mean = float(np.mean(self.nees)) / 3.0
        self.report.row(
            "B6",
            "covariance, pins as drawn of B1 and B2",
            len(self.nees),
            demanded="NEES/3 in 0.8–1.3",
            default=f"{mean:.2f}",
            good=0.8 <= mean <= 1.3,
        )


def clean_rows(bench: Bench) -> None:
    """B1 for every sort of connector and light."""
    fine, bright = (1.0, 0.015), (4.0, 0.015)
    bench.accuracy("B1", "micro-D pins, dark walls", CLEAN, fine)
    bench.accuracy("B1", "micro-D pins, bright walls", replace(CLEAN, wall_light=0.5), bright)
    bench.accuracy("B1", "D-sub pins", replace(CLEAN, name="d-sub-15"), fine, share=0.5)
    bench.accuracy("B1", "micro-D, raw mosaic", replace(CLEAN, pixels="bayer"), fine, share=0.5)
    # A dome has no border where its light changes, so the lamp moves what is seen of it: allowed is
    # 1 µm beyond the bias of walls, 4.1 µm. A run counts 5 µm per axis for light.
    dome, biased = replace(CLEAN, tip="dome"), (5.1, 0.015)
    bench.accuracy("B1", "micro-D, domed tips", dome, biased, share=0.5, as_drawn=False)
    # The walls of bores are lit.
    bench.accuracy("B1", "micro-D holes", HOLES, bright, share=0.5, as_drawn=False)
    large = replace(HOLES, name="d-sub-15")
    bench.accuracy("B1", "D-sub holes", large, bright, share=0.5, as_drawn=False)


def poor_rows(bench: Bench) -> None:
    """B2: poor images, dirt, and lamps that light one side."""
    limits = (3.0, 0.04)
    bench.accuracy("B2", "noise 4, blur 2", POOR, limits, refusals=True)
    for kind, clean in (("pins", CLEAN), ("holes", HOLES)):
        bench.accuracy(
            "B2",
            f"micro-D {kind}, 4 specks of dirt",
            replace(clean, dirt=4),
            limits if kind == "pins" else (4.0, 0.04),
            share=0.5,
            refusals=True,
            as_drawn=False,
        )
        for what, one_sided, arc_deg in (("ring 100 % one-sided", 1.0, None), ("lamp", 0.0, 40.0)):
            lit = replace(clean, one_sided=one_sided, arc_deg=arc_deg)
            bench.refused(f"micro-D {kind}, {what} at one side", lit, LightFromOneSide)
