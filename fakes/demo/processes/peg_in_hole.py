"""The demonstration of a part that finds its hole by touch, held against the true world."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from fakes.demo.control import Control
from fakes.demo.demo import Demo, Evidence, Judgement, Message, Procedure, Row
from fakes.demo.processes.force_row import force_row
from fakes.demo.processes.limited import Limited, failed_figures

CONFIG = Path(__file__).parents[3] / "config"


UNSOLVED_PERCENT = 2.0
"""More, and the fake world itself is not to be believed: in such a step the peg creeps and carries
what the arm presses with."""


def _next_part(control: Control, _cell: Path) -> None:
    control.request("load")


class PegInHoleDemo(Demo):
    """One arm with a force sensor and a gripped plug or pin; its hole lies where nobody sees."""

    process: ClassVar[str] = "peg-in-hole"
    title: ClassVar[str] = "a part finds its hole by touch"
    cell: ClassVar[Path] = CONFIG / "insertion-connector.toml"
    scenario: ClassVar[Path] = CONFIG / "insertion-connector.scenario.toml"
    cells: ClassVar[Mapping[str, Path]] = {
        name: CONFIG / f"insertion-{name}.toml" for name in ("connector", "pin", "pin-rpc")
    }
    serial: ClassVar[str] = "PART-{seed:04d}"
    procedures: ClassVar[Sequence[Procedure]] = (
        Procedure(301, "contact loop: stiffness and dead time", _next_part),
    )
    telling: ClassVar[Sequence[str]] = ("doing",)
    steps: ClassVar[Mapping[int, str]] = {10: "approach", 20: "touch face", 30: "search and insert"}
    forces: ClassVar[Mapping[str, float]] = {"insertion_n": 30.0, "fault_n": 50.0, "fault_nm": 1.0}
    """Greatest 20 ms mean of the true force, 3 ms mean, and moment, where no run was opened: the
    tightest of the cells; else those of its recipe."""

    def prepare(self, control: Control) -> None:
        """The next part and the next face, with what was injected into them."""
        control.request("load")

    def judge(self, evidence: Evidence) -> Judgement:
        """Good is a peg that sits in its own hole, did not slip, and was never pressed too hard."""
        figures = _figures(evidence.truth)
        limited = _limited({**self.forces, **evidence.recipe.get("forces", {})})
        beyond = [one.name for one in limited if not one.within(figures[one.key])]
        beyond += [] if figures["seated"] else ["seated"]
        beyond += [f"{key} of the record" for key in failed_figures(evidence.record)]
        figures["beyond"] = beyond
        return Judgement(evidence.good and not beyond, figures, _rows(figures, limited))

    def news(self, before: Message, now: Message) -> str | None:
        """Phase of the cycle and class of the contact, in the daemon's own words."""
        doing = now.get("doing")
        new = doing != before.get("doing") and now["state"] == "EXECUTE"
        return str(doing) if doing and new else None

    def rows(self, now: Message) -> Mapping[str, str]:
        """Phase and class of contact, depth, force and moments."""
        return {
            "contact": now.get("doing") or "-",
            "to the seat": _to_the_seat(now),
            "force z": force_row(now),
            "moments": _moments(now),
        }


def _to_the_seat(now: Message) -> str:
    depth_mm = (now.get("error_mm") or [None] * 3)[2]
    return "-" if depth_mm is None else f"{-depth_mm:6.2f} mm"


def _moments(now: Message) -> str:
    peaks = [peak for peak in (now.get("force_peaks") or ())[3:] if peak is not None]
    return f"peaks {', '.join(f'{peak:.2f}' for peak in peaks)} N·m" if peaks else "-"


def _limited(forces: Mapping[str, float]) -> Sequence[Limited]:
    insertion_n, fault_n, fault_nm = (forces[key] for key in ("insertion_n", "fault_n", "fault_nm"))
    return (
        Limited("true depth short of the seat, mm", "short_mm", -0.3, 0.3, "{:.3f}"),
        Limited("slip in the fingers, true, mm", "slip_mm", 0.0, 0.15, "{:.3f}"),
        Limited("true force, 20 ms mean, N", "force_20_ms_n", 0.0, insertion_n, "{:.1f}"),
        Limited("true force, 3 ms mean, N", "force_3_ms_n", 0.0, fault_n, "{:.1f}"),
        Limited(
            "true moment at the tip, 3 ms mean, N·m", "moment_3_ms_nm", 0.0, fault_nm, "{:.2f}"
        ),
        Limited(
            "steps of the contact model without an equilibrium, %",
            "unsolved_percent",
            0.0,
            UNSOLVED_PERCENT,
            "{:.2f}",
        ),
    )


def _rows(figures: Mapping[str, Any], limited: Sequence[Limited]) -> list[Row]:
    seated, wrong = figures["seated"], ", ".join(figures["hole_faults"]) or "none"
    return [
        Row("in its hole and seated", seated, limit="True", within=seated),
        Row("wrong with the hole", wrong, limit="none", within=wrong == "none"),
        *(one.row(figures[one.key]) for one in limited),
        Row("true force, at an instant, N", figures["force_1_ms_n"], "{:.1f}"),
    ]


def _figures(truth: Mapping[str, Any]) -> dict[str, Any]:
    force, moment = truth["peak_force_n"], truth["peak_moment_nm"]
    return {
        "seated": truth["seated"],
        "hole_faults": truth["hole_faults"],
        "short_mm": truth["seat_depth_mm"] - truth["depth_mm"],
        "slip_mm": abs(truth["slip_mm"]),
        "force_1_ms_n": force["1_ms"],
        "force_3_ms_n": force["3_ms"],
        "force_20_ms_n": force["20_ms"],
        "moment_3_ms_nm": moment["3_ms"],
        "unsolved_percent": truth["unsolved_percent"],
    }
