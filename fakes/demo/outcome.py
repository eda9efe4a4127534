"""How a demonstration ended: the cell's own result beside the truth of the fake world."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from rich.table import Table

from fakes.demo.children import ChildFailed

LATERAL_LIMIT_MM = 0.2
FORCE_LIMIT_N = 50.0
NEAR_SEAT_MM = 5.0
"""A deck farther away was never mated: its offset says nothing."""


def collect(
    folder: Path, line: dict[str, Any], truth: dict[str, Any], wall_s: float
) -> dict[str, Any]:
    """Enter the gauges, export record and report, write truth.json and result.json."""
    (folder / "truth.json").write_text(json.dumps(truth, indent=2) + "\n", encoding="utf-8")
    run = int(line.get("run") or 0)
    pins: dict[str, dict[str, float]] = truth.get("pins", {})
    record: dict[str, Any] = {}
    if run:
        if line.get("result") == "good":
            for name, pin in pins.items():
                gauge = ["--hole", name, "--mm", f"{pin['gauge_mm']:.2f}", "--source", "simulator"]
                _cellctl(folder, "runs", "gauge", str(run), *gauge)
        _cellctl(folder, "runs", "export", str(run), "--out", str(folder / "report"))
        record = json.loads((folder / "report" / "run.json").read_text(encoding="utf-8"))
    outcome = _outcome(line, truth, pins, record, wall_s)
    outcome["report"] = str(folder / "report" / "report.html") if run else ""
    (folder / "result.json").write_text(json.dumps(outcome, indent=2) + "\n", encoding="utf-8")
    return outcome


def _outcome(
    line: dict[str, Any],
    truth: dict[str, Any],
    pins: dict[str, dict[str, float]],
    record: dict[str, Any],
    wall_s: float,
) -> dict[str, Any]:
    pose = truth.get("frame_T_deck_mm_deg", [None] * 6)
    figures = {figure["key"]: figure["value"] for figure in record.get("figures", [])}
    passes = record.get("passes", [])
    last = [component["value"] for component in passes[-1]["components"]] if passes else None
    offsets = [pin["offset_mm"] for pin in pins.values()]
    peak_true_n = truth["peak_contact_force_n"]
    good = line.get("result") == "good"
    within = bool(offsets) and max(offsets) < LATERAL_LIMIT_MM and peak_true_n < FORCE_LIMIT_N
    return {
        "seed": truth["seed"],
        "passed": good and within,
        "result": line.get("result"),
        "fault": record.get("fault") or line.get("message") or "",
        "iterations": len(passes),
        "measured_error_mm_deg": last,
        "true_frame_T_deck_mm_deg": pose,
        "lateral_mm": max(offsets) if offsets else None,
        "rotation_deg": None if pose[0] is None else max(abs(angle) for angle in pose[3:]),
        "seat_gap_mm": None if pose[0] is None else pose[2] - truth["deck_thickness_mm"],
        "peak_true_n": peak_true_n,
        "final_true_n": truth["contact_force_n"],
        "peak_sensed_n": figures.get("peak_force"),
        "hold_force_n": figures.get("hold_force"),
        "gauge_mm": {name: pin["gauge_mm"] for name, pin in pins.items()},
        "gauge_min_mm": min((pin["gauge_mm"] for pin in pins.values()), default=None),
        "wall_s": wall_s,
    }


def result_table(outcome: dict[str, Any]) -> Table:
    """For the end of the demonstration."""
    table = Table("figure", "value", "limit", title=f"seed {outcome['seed']}: {outcome['result']}")
    mated = outcome["seat_gap_mm"] is not None and abs(outcome["seat_gap_mm"]) < NEAR_SEAT_MM
    truth = outcome if mated else {}
    gauge_mm: dict[str, float] = truth.get("gauge_mm", {})
    gauges = ", ".join(f"{name} {value:.2f}" for name, value in gauge_mm.items())
    rows = (
        ("iterations of the loop", outcome["iterations"], "{}", ""),
        ("true offset at the pin holes, mm", truth.get("lateral_mm"), "{:.4f}", "0.2"),
        ("true rotation, worst axis, deg", truth.get("rotation_deg"), "{:.5f}", ""),
        ("true seat gap, mm", truth.get("seat_gap_mm"), "{:.4f}", ""),
        ("peak contact force, true, N", outcome["peak_true_n"], "{:.1f}", "50"),
        ("peak contact force, sensed, N", outcome["peak_sensed_n"], "{:.1f}", "50"),
        ("force held, sensed, N", outcome["hold_force_n"], "{:.1f}", "35 … 45"),
        ("force left for fastening, true, N", outcome["final_true_n"], "{:.1f}", ""),
        ("wall time, s", outcome["wall_s"], "{:.0f}", ""),
    )
    for name, value, form, limit in rows:
        table.add_row(name, "–" if value is None else form.format(value), limit)
    table.add_row("largest plug gauge, mm", gauges or "–", "5.80 … 6.00")
    return table


def _cellctl(folder: Path, *arguments: str) -> None:
    command = [sys.executable, "-m", "cellctl", *arguments, "--data-dir", str(folder / "store")]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    if done.returncode:
        raise ChildFailed(f"cellctl {' '.join(arguments)}:\n{done.stderr.strip()}")
