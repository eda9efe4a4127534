"""The demonstration of deck-to-frame: one deck on its frame, held against the true world."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from fakes.demo.demo import Demo, Evidence, Judgement, Message, Procedure, Row
from fakes.demo.processes.deck_calibration import PROCEDURES
from fakes.demo.processes.force_row import force_row
from fakes.demo.processes.limited import Limited, failed_figures

CONFIG = Path(__file__).parents[3] / "config"
NEAR_SEAT_MM = 5.0
"""A deck farther away was never mated: its offset says nothing."""
_AXES = ("x", "y", "z")


LIMITED = (
    Limited("true offset at the pin holes, mm", "lateral_mm", 0.0, 0.2, "{:.4f}"),
    Limited("true rotation about y or z, deg", "rotation_deg", 0.0, 0.01, "{:.5f}"),
    Limited("true rotation about x, deg", "rotation_about_x_deg", 0.0, 0.02, "{:.5f}"),
    Limited("true seat gap, mm", "seat_gap_mm", -0.1, 0.1, "{:.4f}"),
    Limited("peak contact force, true, N", "peak_true_n", 0.0, 50.0, "{:.1f}", of_the_seat=False),
    Limited(
        "peak contact force, sensed, N", "peak_sensed_n", 0.0, 50.0, "{:.1f}", of_the_seat=False
    ),
    Limited("force held, sensed, N", "hold_force_n", 35.0, 45.0, "{:.1f}", of_the_seat=False),
    Limited("force left for fastening, true, N", "final_true_n", 5.0, 25.0, "{:.1f}"),
    Limited("smallest of the largest plug gauges, mm", "gauge_min_mm", 5.8, 6.0001, "{:.2f}"),
)
"""What the cell judges by its sensors is judged here by the truth, with the same limits.

The force that is left is 10 to 20 N as sensed: 5 N more either way are for the error of the
sensor's zero.
"""


class DeckToFrameDemo(Demo):
    """Three robots, two stereo heads, a tracker, a force sensor; one deck and its frame."""

    process: ClassVar[str] = "deck-to-frame"
    title: ClassVar[str] = "one deck on its frame"
    cell: ClassVar[Path] = CONFIG / "deck.toml"
    scenario: ClassVar[Path] = CONFIG / "deck.scenario.toml"
    mate_serial: ClassVar[str] = "FRAME-{seed:04d}"
    procedures: ClassVar[Sequence[Procedure]] = PROCEDURES
    steps: ClassVar[Mapping[int, str]] = {
        10: "measure frame",
        20: "measure deck",
        30: "pre-assembly",
        40: "correct pose",
        50: "mate",
        60: "verify",
        101: "calibrate head 1",
        102: "calibrate head 2",
        103: "calibrate base frame",
        104: "calibrate board 1",
        105: "calibrate board 2",
        106: "identify payload",
        107: "measure stop latency",
        108: "measure contact stiffness",
    }

    def measure(self, evidence: Evidence) -> Sequence[Sequence[str]]:
        """Plug gauges in the pin holes of a good part."""
        pins: Mapping[str, Any] = evidence.truth.get("pins", {}) if evidence.good else {}
        run, source = str(evidence.result.get("run")), ("--source", "simulator")
        return [
            ("gauge", run, "--hole", name, "--mm", f"{pin['gauge_mm']:.2f}", *source)
            for name, pin in pins.items()
        ]

    def judge(self, evidence: Evidence) -> Judgement:
        """Every figure of a good part, as it truly was and as the record has it."""
        figures = _figures(evidence)
        beyond = [one.name for one in LIMITED if not one.within(figures[one.key])]
        beyond += [f"{key} of the record" for key in failed_figures(evidence.record)]
        if evidence.record and not _converged(evidence.record):
            beyond.append("convergence of the loop")
        figures |= {"beyond": beyond}
        return Judgement(evidence.good and not beyond, figures, _rows(figures))

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
            "force z": force_row(now),
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
        "errors_mm_deg": [
            [component["value"] for component in one["components"]] for one in passes
        ],
        "true_frame_T_deck_mm_deg": pose,
        "lateral_mm": max(offsets) if offsets else None,
        **rotations(pose),
        "seat_gap_mm": None if pose[0] is None else pose[2] - truth["deck_thickness_mm"],
        "peak_true_n": truth["peak_contact_force_n"],
        "final_true_n": truth["contact_force_n"],
        "peak_sensed_n": measured.get("peak_force"),
        "hold_force_n": measured.get("hold_force"),
        "gauge_mm": {name: pin["gauge_mm"] for name, pin in pins.items()},
        "gauge_min_mm": min((pin["gauge_mm"] for pin in pins.values()), default=None),
        "seat_normalised": _normalised(evidence),
    }


def rotations(frame_T_deck_mm_deg: Sequence[float | None]) -> dict[str, float | None]:
    """True rotation about x, and the larger one of those about y and z; None without a deck."""
    known = [abs(angle) for angle in frame_T_deck_mm_deg[3:] if angle is not None]
    if not known:
        return {"rotation_deg": None, "rotation_about_x_deg": None}
    about_z, about_y, about_x = known  # the order of a written pose
    return {"rotation_deg": max(about_y, about_z), "rotation_about_x_deg": about_x}


def _normalised(evidence: Evidence) -> list[float] | None:
    """What the cameras were off the truth of the seated deck, over what they said of themselves.

    Six components; None for a run that did not come to that look.
    """
    figures = {one["key"]: one["value"] for one in evidence.record.get("figures", ())}
    found, sigmas = (
        [figures.get(f"seated_{what}.{axis}") for axis in ("x", "y", "z", "rx", "ry", "rz")]
        for what in ("error", "sigma")
    )
    pose = evidence.truth.get("frame_T_deck_mm_deg")
    if pose is None or None in found or None in sigmas:
        return None
    x, y, z, about_z, about_y, about_x = pose
    true_error = [-x, -y, evidence.recipe["deck_thickness_mm"] - z, -about_x, -about_y, -about_z]
    columns = zip(found, true_error, sigmas, strict=True)
    return [(one - true) / sigma for one, true, sigma in columns]


def _converged(record: Mapping[str, Any]) -> bool:
    passes = record.get("passes", [])
    return bool(passes) and passes[-1]["converged"] is True


def _rows(figures: Mapping[str, Any]) -> list[Row]:
    gap_mm = figures["seat_gap_mm"]
    mated = gap_mm is not None and abs(gap_mm) < NEAR_SEAT_MM
    limited = [
        one.row(figures[one.key] if mated or not one.of_the_seat else None) for one in LIMITED
    ]
    return [Row("iterations of the loop", figures["iterations"]), *limited]


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
