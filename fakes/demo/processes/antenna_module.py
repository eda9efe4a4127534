"""The demonstration of the antenna module: one module plugged, held against the true world."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from fakes.demo.control import Control
from fakes.demo.demo import Demo, Evidence, Judgement, Message, Procedure, Row
from fakes.demo.processes.antenna_calibration import PROCEDURES
from fakes.demo.processes.force_row import force_row
from fakes.demo.processes.limited import Limited, failed_figures

CONFIG = Path(__file__).parents[3] / "config"

LIMITED = (
    Limited("true offset at the worst contact as it met, mm", "met_offset_mm", 0.0, 0.05, "{:.4f}"),
    Limited("true depth beyond the seat, mm", "beyond_seat_mm", -0.15, 0.15, "{:.4f}"),
    Limited("highest side force on a contact, true, N", "peak_side_n", 0.0, 3.0, "{:.2f}"),
    Limited("highest axial force on a contact, true, N", "peak_axial_n", 0.0, 20.0, "{:.2f}"),
    Limited("highest force of the insertion, true, N", "peak_total_n", 0.0, 52.0, "{:.1f}"),
)
"""Axial forces on a contact are those of its wall and of the face, without its own spring."""


class AntennaModuleDemo(Demo):
    """One arm with gripper, force sensor and camera I, camera II beside it; a module, a panel."""

    process: ClassVar[str] = "antenna-module"
    title: ClassVar[str] = "one antenna module into its socket"
    cell: ClassVar[Path] = CONFIG / "antenna.toml"
    scenario: ClassVar[Path] = CONFIG / "antenna.scenario.toml"
    serial: ClassVar[str] = "MOD-{seed:04d}"
    mate_serial: ClassVar[str] = "BOARD-{seed:04d}"
    procedures: ClassVar[Sequence[Procedure]] = PROCEDURES
    steps: ClassVar[Mapping[int, str]] = {
        10: "check reference",
        20: "find module",
        30: "pick",
        40: "inspect plug",
        45: "grip again",
        46: "put back",
        50: "locate socket",
        60: "plan",
        70: "stand-off",
        80: "insert",
        90: "verify",
    }

    def judge(self, evidence: Evidence) -> Judgement:
        """Where the module is, what became of its pins, and every figure of a good plug."""
        figures = _figures(evidence.truth)
        beyond = [one.name for one in LIMITED if not one.within(figures[one.key])]
        beyond += _not_as_it_should_be(figures)
        beyond += [f"{key} of the record" for key in failed_figures(evidence.record)]
        figures |= {"beyond": beyond}
        return Judgement(evidence.good and not beyond, figures, _rows(figures))

    def prepare(self, control: Control) -> None:
        """The board is put away, nobody stands by to plug what the cell plugs itself, and a module
        is laid on the tray: with what was injected into it."""
        control.request("remove_boards")
        control.request("stand_by", on=False)
        control.request("load")

    def rows(self, now: Message) -> Mapping[str, str]:
        """The force of the insertion."""
        return {"force z": force_row(now)}


def _figures(truth: Mapping[str, Any]) -> dict[str, Any]:
    pins: Mapping[str, str] = truth["pins"]
    return {
        "module": truth["module"],
        "pins_inside": sum(state == "inside" for state in pins.values()),
        "pins": len(pins),
        "damaged": sorted(
            {name for name, state in pins.items() if state == "collapsed"} | {*truth["bent"]}
        ),
        "met_offset_mm": truth["met_offset_at_worst_contact_mm"],
        "beyond_seat_mm": truth["seated_depth_mm"] - truth["seat_depth_mm"],
        "peak_side_n": max(truth["peak_side_n"].values()),
        "peak_axial_n": max(truth["peak_axial_n"].values()),
        "peak_total_n": truth["peak_total_n"],
    }


def _not_as_it_should_be(figures: Mapping[str, Any]) -> list[str]:
    wrong = []
    if figures["module"] != "socket":
        wrong.append("place of the module")
    if figures["pins_inside"] < figures["pins"]:
        wrong.append("pins inside")
    if figures["damaged"]:
        wrong.append("bent or collapsed pins")
    return wrong


def _rows(figures: Mapping[str, Any]) -> list[Row]:
    """A plug that never came to its socket has no depth and no offset to show."""
    plugged = figures["pins_inside"] > 0
    inside = figures["pins_inside"] == figures["pins"]
    damaged = ", ".join(figures["damaged"]) or "none"
    return [
        Row("module", figures["module"], within=figures["module"] == "socket", limit="socket"),
        Row("pins inside", figures["pins_inside"], limit=str(figures["pins"]), within=inside),
        Row("bent or collapsed pins", damaged, limit="none", within=damaged == "none"),
        *(one.row(figures[one.key] if plugged or not one.of_the_seat else None) for one in LIMITED),
    ]
