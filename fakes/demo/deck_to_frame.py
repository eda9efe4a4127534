"""The demonstration of deck-to-frame: one deck on its frame, held against the true world."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from fakes.demo.deck_calibration import PROCEDURES
from fakes.demo.demo import Demo, Evidence, Judgement, Message, Procedure, Row

CONFIG = Path(__file__).parents[2] / "config"
LATERAL_LIMIT_MM = 0.2
FORCE_LIMIT_N = 50.0
NEAR_SEAT_MM = 5.0
"""A deck farther away was never mated: its offset says nothing."""
_AXES = ("x", "y", "z")


class DeckToFrameDemo(Demo):
    """Three robots, two stereo heads, a tracker, a force sensor; one deck and its frame."""

    process: ClassVar[str] = "deck-to-frame"
    title: ClassVar[str] = "one deck on its frame"
    cell: ClassVar[Path] = CONFIG / "deck.toml"
    scenario: ClassVar[Path] = CONFIG / "deck.scenario.toml"
    procedures: ClassVar[Sequence[Procedure]] = PROCEDURES

    def measure(self, evidence: Evidence) -> Sequence[Sequence[str]]:
        """Plug gauges in the pin holes of a good part."""
        pins: Mapping[str, Any] = evidence.truth.get("pins", {}) if evidence.good else {}
        run, source = str(evidence.result.get("run")), ("--source", "simulator")
        return [
            ("gauge", run, "--hole", name, "--mm", f"{pin['gauge_mm']:.2f}", *source)
            for name, pin in pins.items()
        ]

    def judge(self, evidence: Evidence) -> Judgement:
        """Offsets at the pin holes and the contact force, as they truly were."""
        figures = _figures(evidence)
        lateral_mm, peak_true_n = figures["lateral_mm"], figures["peak_true_n"]
        within = (
            lateral_mm is not None and lateral_mm < LATERAL_LIMIT_MM and peak_true_n < FORCE_LIMIT_N
        )
        return Judgement(evidence.good and within, figures, _rows(figures))

    def news(self, before: Message, now: Message) -> str | None:
        """A new pass of the loop: its number and the error that it found."""
        iteration = now.get("iteration")
        if iteration and iteration != before.get("iteration"):
            return f"#{iteration}  {_errors(now)}"
        return None

    def rows(self, now: Message) -> Mapping[str, str]:
        """The error of the loop and the force of the approach."""
        return {
            "iteration": str(now.get("iteration") or "-"),
            "error": _errors(now).replace("  r", "\nr") or "-",
            "force z": _force(now),
        }


def _figures(evidence: Evidence) -> dict[str, Any]:
    truth, record = evidence.truth, evidence.record
    pins: Mapping[str, Mapping[str, float]] = truth.get("pins", {})
    pose = truth.get("frame_T_deck_mm_deg", [None] * 6)
    measured = {figure["key"]: figure["value"] for figure in record.get("figures", [])}
    passes = record.get("passes", [])
    offsets = [pin["offset_mm"] for pin in pins.values()]
    return {
        "iterations": len(passes),
        "measured_error_mm_deg": (
            [component["value"] for component in passes[-1]["components"]] if passes else None
        ),
        "true_frame_T_deck_mm_deg": pose,
        "lateral_mm": max(offsets) if offsets else None,
        "rotation_deg": None if pose[0] is None else max(abs(angle) for angle in pose[3:]),
        "seat_gap_mm": None if pose[0] is None else pose[2] - truth["deck_thickness_mm"],
        "peak_true_n": truth["peak_contact_force_n"],
        "final_true_n": truth["contact_force_n"],
        "peak_sensed_n": measured.get("peak_force"),
        "hold_force_n": measured.get("hold_force"),
        "gauge_mm": {name: pin["gauge_mm"] for name, pin in pins.items()},
        "gauge_min_mm": min((pin["gauge_mm"] for pin in pins.values()), default=None),
    }


def _rows(figures: Mapping[str, Any]) -> list[Row]:
    gap_mm = figures["seat_gap_mm"]
    mated = gap_mm is not None and abs(gap_mm) < NEAR_SEAT_MM
    truth = figures if mated else {}
    gauge_mm: Mapping[str, float] = truth.get("gauge_mm", {})
    gauges = ", ".join(f"{name} {value:.2f}" for name, value in gauge_mm.items())
    return [
        Row("iterations of the loop", figures["iterations"]),
        Row("true offset at the pin holes, mm", truth.get("lateral_mm"), "{:.4f}", "0.2"),
        Row("true rotation, worst axis, deg", truth.get("rotation_deg"), "{:.5f}"),
        Row("true seat gap, mm", truth.get("seat_gap_mm"), "{:.4f}"),
        Row("peak contact force, true, N", figures["peak_true_n"], "{:.1f}", "50"),
        Row("peak contact force, sensed, N", figures["peak_sensed_n"], "{:.1f}", "50"),
        Row("force held, sensed, N", figures["hold_force_n"], "{:.1f}", "35 … 45"),
        Row("force left for fastening, true, N", figures["final_true_n"], "{:.1f}"),
        Row("largest plug gauge, mm", gauges or None, limit="5.80 … 6.00"),
    ]


def _force(now: Message) -> str:
    force, limit = now.get("force_z_n"), now.get("force_limit_n")
    peak = (now.get("force_peaks") or [None] * 3)[2]
    parts = ["-" if force is None else f"{force + 0.0:7.2f} N"]
    if peak is not None:
        parts.append(f"peak {peak:.1f} N")
    if limit is not None:
        parts.append(f"limit {limit:.0f} N")
    return "   ".join(parts)


def _errors(now: Message) -> str:
    """Lengths to a micrometre, angles to a ten-thousandth of a degree; empty without any."""
    millimetres, degrees = now.get("error_mm") or [], now.get("error_deg") or []
    if not any(value is not None for value in (*millimetres, *degrees)):
        return ""
    return f"{_written('', millimetres, 3)} mm  {_written('r', degrees, 4)} °"


def _written(prefix: str, values: Sequence[float | None], digits: int) -> str:
    return " ".join(
        f"{prefix}{axis} " + ("-" if value is None else f"{value:+.{digits}f}")
        for axis, value in zip(_AXES, values, strict=True)
    )
