"""One run on the whole cell: fake cell, daemon and line PLC as the demonstration starts them."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from benchmarks.tornado.cases import Case
from benchmarks.tornado.outcome import Outcome, Verdict
from cellctl.version import software

_END_S = 90.0
"""Time for the demonstration to stop its robots and to close its run."""


class NoResult(RuntimeError):
    """The demonstration ended without one; nothing is known about the case."""


def run_cell(case: Case, folder: Path) -> Outcome:
    """Run the demonstration of a case, its record in ``folder``; raises ``NoResult``."""
    result_path = folder / "result.json"
    result_path.unlink(missing_ok=True)
    command = [sys.executable, "-m", "fakes", "demo", "--quiet", "--out", str(folder)]
    command += ["--seed", str(case.seed)]
    for name, scale in case.scales().items():
        command += ["--imperfection", f"{name}={scale:g}"]
    begun = time.monotonic()
    said = _run(command)
    if not result_path.exists():
        raise NoResult(said[-400:] or "the demonstration said nothing")
    result: dict[str, Any] = json.loads(result_path.read_text(encoding="utf-8"))
    return Outcome(
        case=case,
        verdict=_verdict(result),
        text=str(result["fault"] or ", ".join(result["beyond"])),
        lateral_mm=result["lateral_mm"],
        rotation_deg=result["rotation_deg"],
        seat_gap_mm=result["seat_gap_mm"],
        peak_n=result["peak_true_n"],
        final_n=result["final_true_n"],
        iterations=result["iterations"],
        wall_s=time.monotonic() - begun,
        software=software(),
    )


def _verdict(result: dict[str, Any]) -> Verdict:
    if result["result"] != "good":
        return Verdict.NOTICED
    return Verdict.GOOD if result["passed"] else Verdict.NOT_NOTICED


def _run(command: list[str]) -> str:
    """What the command complained of. Ctrl-C reaches it as it would in a terminal of its own."""
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        return process.communicate()[1]
    except KeyboardInterrupt:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=_END_S)
        raise
