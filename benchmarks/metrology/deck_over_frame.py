"""Rims as the deck process sees them: ``python -m benchmarks.metrology.deck_over_frame``.

World, renderer and calibrations are those of ``cellctl demo``, and so are the looks: the frame, the
deck on its way to it, and the deck that hangs over its frame and hides a part of it. An unmoved
scene is taken several times, with other noise and light. Beside the errors against truth stands how
far a centre moves from one frame to the next, against what is stated of it: a model that is not
sure of itself shows there first.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # Threads only slow the small solves down.

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

import cv2
import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.metrology.fake_station import HEADS, SCENARIO, FakeStation, Shot
from benchmarks.metrology.figures import HoleErrors
from benchmarks.metrology.loop import Setting
from cellctl.errors.vision import VisionError
from cellctl.geometry.pose import MM, Array
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.features.hole import Hole
from cellctl.vision.measure import measure_pair
from fakes.render import api
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.world.scene import ScenePlate, StereoTruth
from tests.rigs.metrology.views import HeadView

SEEDS, FRAMES = (5, 1, 3), 6
STEP_GREY = 80.0
"""Typical difference of grey at these rims."""
MOST_P95_PX, MOST_JITTER_PX, MOST_SIGMA_PX = 0.06, 0.02, 0.03
MOST_JITTER_SIGMAS, MOST_SQUARED = 1.2, 2.0
"""Bounds: 95 % of the centres, movement from frame to frame (rms), stated standard deviation
(median), movement over what is stated, and error² over its degrees of freedom. Six frames of one
scene share most of an error, so that the last two scatter by a quarter and more."""

Look = Literal["30 frame", "40 deck", "60 deck over frame"]
LOOKS: tuple[Look, ...] = ("30 frame", "40 deck", "60 deck over frame")


@dataclass
class Steadiness:
    """Centres of one kind of hole in unmoved scenes."""

    errors: HoleErrors = field(default_factory=HoleErrors)
    moved_px: list[float] = field(default_factory=list)
    """Squares of both coordinates about the mean of the frames, without bias."""
    stated_px: list[float] = field(default_factory=list)
    """Stated standard deviation along one axis, rms of both."""
    farthest_px: float = 0.0
    """Longest way between any two frames."""

    def add(self, offs_px: Array, covariances_px2: Array) -> None:
        """Errors (n, 2) of one rim in one camera over n frames, and what was stated (n, 2, 2)."""
        count = len(offs_px)
        self.stated_px.extend(np.sqrt(np.trace(covariances_px2, axis1=1, axis2=2) / 2.0))
        if count < 2:
            return
        about = offs_px - offs_px.mean(axis=0)
        self.moved_px.extend((about**2).ravel() * count / (count - 1))
        ways = np.linalg.norm(offs_px[:, None] - offs_px, axis=2)
        self.farthest_px = max(self.farthest_px, float(ways.max()))

    @property
    def jitter_px(self) -> float:
        """Movement from frame to frame, rms along one axis."""
        return float(np.sqrt(np.mean(self.moved_px))) if self.moved_px else 0.0

    @property
    def sigma_px(self) -> float:
        """What is stated, median."""
        return float(np.median(self.stated_px))

    @property
    def squared(self) -> float:
        """Error² over its degrees of freedom."""
        return float(np.mean(self.errors.squared_2d)) / 2.0


@dataclass
class Steady:
    """All kinds of hole in all looks."""

    rims: dict[tuple[str, str], Steadiness] = field(default_factory=dict)
    """By look and kind."""
    refused: dict[str, list[str]] = field(default_factory=dict)
    pairs: dict[str, int] = field(default_factory=dict)

    def take(self, look: str, views: Sequence[HeadView]) -> None:
        """Measure one unmoved scene of one head in all its frames."""
        found: dict[str, list[tuple[Array, Array]]] = {}
        kinds = {hole.name: hole.kind for hole in views[0].holes}
        self.pairs[look] = self.pairs.get(look, 0) + len(views)
        for view in views:
            try:
                result = measure_pair(
                    *view.images, view.head, view.holes, camera_T_part=view.camera_T_part
                )
            except VisionError as fault:
                self.refused.setdefault(look, []).append(str(fault))
                continue
            for hole in result.holes:
                self._of(look, hole.kind).errors.add(view, hole, STEP_GREY)
                points_px = np.array([hole.left_px, hole.right_px])
                covariances = np.array([hole.left_covariance_px2, hole.right_covariance_px2])
                offs_px = points_px - np.array(view.truth_px[hole.name])
                found.setdefault(hole.name, []).append((offs_px, covariances))
        for name, frames in found.items():
            offs_px, covariances = (np.array(part) for part in zip(*frames, strict=True))
            for side in (0, 1):
                self._of(look, kinds[name]).add(offs_px[:, side], covariances[:, side])

    def _of(self, look: str, kind: str) -> Steadiness:
        return self.rims.setdefault((look, kind), Steadiness())


def looks_of(
    setting: Setting,
    scenario: DeckScenario,
    seed: int,
    frames: int,
    wanted: Sequence[Look] = LOOKS,
) -> Iterator[tuple[Look, list[HeadView]]]:
    """The wanted looks of one drawn cell, of one head after the other."""
    station = FakeStation(scenario, seed, setting.geometry)
    recipe = setting.recipe

    def views(look: Look) -> Iterator[tuple[Look, list[HeadView]]]:
        if look not in wanted:
            return
        part, features = ("frame", setting.frame) if look == LOOKS[0] else ("deck", setting.deck)
        heads = setting.geometry.head_1, setting.geometry.head_2
        holes = features.seen_by(1), features.seen_by(2)
        shots = []
        for _ in range(frames):
            station.wait()
            shots.append([station.shot(head) for head in HEADS])
        for index, of_head in enumerate(zip(*shots, strict=True)):
            yield look, [_view(station, shot, heads[index], part, holes[index]) for shot in of_head]

    yield from views("30 frame")
    station.to_deck_measure()
    yield from views("40 deck")
    station.to_stand_off((recipe.deck_thickness_mm + recipe.stand_off_mm) * MM)
    yield from views("60 deck over frame")


def _view(
    station: FakeStation, shot: Shot, head: StereoHead, part: str, holes: Sequence[Hole]
) -> HeadView:
    """A shot with the truth of this exposure: the head sways from one to the next."""
    stereo = shot.scene.optics
    assert isinstance(stereo, StereoTruth)
    (plate,) = [
        body for body in shot.scene.bodies if isinstance(body, ScenePlate) and body.name == part
    ]
    sways_px = [np.array(shot.scene.exposure.sway_rad) * lens.focal_px[0]
                for lens in (stereo.left, stereo.right)]  # fmt: skip
    centres_px = api.project_hole_centres(stereo, plate, station.look)
    return HeadView(
        head,
        tuple(holes),
        plate.camera_T_part,
        shot.images,
        {
            name: (left + sways_px[0], right + sways_px[1])
            for name, (left, right) in centres_px.items()
        },
        api.hole_centres_m(plate, station.look),
        stereo.left.blur_px,
    )


def judged(steady: Steady) -> tuple[Table, bool]:
    """The figures, and whether all are within their bounds."""
    table = Table(
        "look", "kind", "p95, px", "worst, px", "error² / freedom",
        "frame to frame, px", "farthest, px", "stated, px", "moved / stated", "refused",
    )  # fmt: skip
    good = not steady.refused
    for (look, kind), rims in steady.rims.items():
        share = rims.jitter_px / rims.sigma_px
        table.add_row(
            look, kind, f"{rims.errors.p95_px():.3f}", f"{rims.errors.worst_px():.3f}",
            f"{rims.squared:.2f}", f"{rims.jitter_px:.4f}", f"{rims.farthest_px:.3f}",
            f"{rims.sigma_px:.4f}", f"{share:.2f}",
            f"{len(steady.refused.get(look, []))} of {steady.pairs[look]}",
        )  # fmt: skip
        good &= rims.errors.p95_px() < MOST_P95_PX and rims.jitter_px < MOST_JITTER_PX
        good &= rims.sigma_px < MOST_SIGMA_PX and rims.squared < MOST_SQUARED
        good &= share < MOST_JITTER_SIGMAS
    return table, good


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, nargs="+", default=SEEDS)
    parser.add_argument("--frames", type=int, default=FRAMES)
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    setting, scenario, steady = Setting.shipped(), DeckScenario.read(SCENARIO), Steady()
    for seed in track(arguments.seeds, "drawn cells", transient=True):
        for look, views in looks_of(setting, scenario, seed, arguments.frames):
            steady.take(look, views)
    table, good = judged(steady)
    Console(width=150).print(table)
    for where, faults in steady.refused.items():
        print(f"{where}: {'; '.join(faults)}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
