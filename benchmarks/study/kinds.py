"""The trials that a study can repeat: each is one seed of a campaign that there is."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from rich.table import Table

from benchmarks.study.outcome import StudyOutcome
from cellctl.errors.base import CellError

Scales = Mapping[str, float]
"""Imperfections in place of those of the scenario file, by name."""


@dataclass(frozen=True, slots=True)
class StudyFigure:
    """A number of every trial, drawn as a distribution."""

    key: str
    title: str
    limit: float | None = None


@dataclass(frozen=True, slots=True)
class StudyKind:
    """One sort of trial."""

    name: str
    about: str
    run: Callable[[int, Scales], StudyOutcome]
    figures: Sequence[StudyFigure]
    tables: Callable[[Sequence[StudyOutcome]], Iterable[Table]] = lambda _: ()
    scaled: bool = False
    """Whether imperfections can be scaled."""


def run_seed(name: str, seed: int, scales: Scales) -> dict[str, Any]:
    """One trial, by the name of its kind: what a worker is asked for."""
    return KINDS[name].run(seed, scales).row()


# What follows loads the campaign that it is about when it is asked for: a worker needs one of them.
@cache
def _setting() -> Any:
    import cv2

    from benchmarks.metrology.loop import Setting

    # A worker has one processor; threads of OpenCV would wait for each other.
    cv2.setNumThreads(1)
    return Setting.shipped()


@cache
def _scenario(scales: tuple[tuple[str, float], ...]) -> Any:
    from benchmarks.metrology.fake_station import SCENARIO
    from fakes.scenes.deck_on_frame.scenario import DeckScenario

    return DeckScenario.read(SCENARIO, dict(scales))


_COMPONENTS = ("x_mm", "y_mm", "z_mm", "rx_deg", "ry_deg", "rz_deg")
_LIMITS = (0.05,) * 3 + (0.005,) * 3


def _deck_loop(seed: int, scales: Scales) -> StudyOutcome:
    """Frame and deck measured, the deck corrected until it is within the thresholds."""
    from benchmarks.metrology.loop import run_loop

    try:
        found = run_loop(_setting(), _scenario(tuple(sorted(scales.items()))), seed)
    except CellError as fault:
        return StudyOutcome(seed, good=False, called_good=False, fault=str(fault))
    looks = found["looks"]
    off = dict(zip(_COMPONENTS, map(abs, looks[-1]["off_truth_mm_deg"]), strict=True))
    frames = sum(look["frames"][0] for look in looks)
    figures = off | {"looks": float(len(looks)), "frames": float(frames)}
    converged = bool(found["converged"])
    # The part is where it was said to be: three times the threshold would be another place.
    true = all(off[key] <= 3 * limit for key, limit in zip(_COMPONENTS, _LIMITS, strict=True))
    return StudyOutcome(seed, converged and true, converged, "", figures, found)


def _deck_loop_tables(outcomes: Sequence[StudyOutcome]) -> Iterable[Table]:
    from benchmarks.campaign import decay
    from benchmarks.metrology.loop import normalised

    found = [dict(one.detail) for one in outcomes if one.detail]
    return (decay(found), normalised(found)) if found else ()


def _deck_mating(seed: int, _scales: Scales) -> StudyOutcome:
    """A drawn stiffness and stop latency, mated under force without pins."""
    from tests.rigs.mating.trial import draw_trial, run_trial

    trial = run_trial(draw_trial(seed))
    keys = ("true_peak_n", "sensed_peak_n", "final_true_n", "duration_s")
    figures = {key: float(getattr(trial, key)) for key in keys}
    seated = trial.complete and not trial.false_complete
    fault = "" if trial.complete else f"{trial.outcome} {trial.text}".strip()
    return StudyOutcome(seed, seated, trial.complete, fault, figures)


@cache
def _insertion_cell(name: str) -> Any:
    from benchmarks.insertion.cycles import CycleCell

    return CycleCell.shipped(name)


def _insertion(name: str) -> Callable[[int, Scales], StudyOutcome]:
    def run(seed: int, _scales: Scales) -> StudyOutcome:
        """A whole cycle by touch, contact world included."""
        from benchmarks.insertion.cycles import run_cycle

        found = run_cycle(_insertion_cell(name), seed)
        figures = {
            "search_s": found.search_s,
            "cycle_s": found.cycle_s,
            "peak_n": max((found.peak_n(phase, 3) for phase in found.peaks), default=0.0),
        }
        good = found.called_good and found.seated
        return StudyOutcome(seed, good, found.called_good, str(found.fault or ""), figures)

    return run


_OFF_TRUTH = tuple(
    StudyFigure(key, f"{key.replace('_', ' ')} off the truth", limit)
    for key, limit in zip(_COMPONENTS, _LIMITS, strict=True)
)
_CYCLE_FIGURES = (
    StudyFigure("search_s", "search, s"),
    StudyFigure("cycle_s", "cycle, s"),
    StudyFigure("peak_n", "greatest force, 3 ms mean, N"),
)
KINDS: Mapping[str, StudyKind] = {
    kind.name: kind
    for kind in (
        StudyKind(
            "deck-loop",
            "deck-to-frame: measure and correct on drawn cells, without the wire",
            _deck_loop,
            (
                *_OFF_TRUTH,
                StudyFigure("looks", "looks"),
                StudyFigure("frames", "frames in all looks"),
            ),
            _deck_loop_tables,
            scaled=True,
        ),
        StudyKind(
            "deck-mating",
            "deck-to-frame: mating under force over stiffness and stop latency",
            _deck_mating,
            (
                StudyFigure("true_peak_n", "true peak, N", 50.0),
                StudyFigure("sensed_peak_n", "sensed peak, N"),
                StudyFigure("final_true_n", "true force at the end, N"),
                StudyFigure("duration_s", "duration, s"),
            ),
        ),
        StudyKind(
            "peg-pin", "peg-in-hole: whole cycles of the pin", _insertion("pin"), _CYCLE_FIGURES
        ),
        StudyKind(
            "peg-connector",
            "peg-in-hole: whole cycles of the connector",
            _insertion("connector"),
            _CYCLE_FIGURES,
        ),
    )
}
"""Kinds of studies by their names."""
