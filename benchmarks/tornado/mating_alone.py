"""One run of the mating alone, on simulated time, with truth for the measuring loop before it."""

import time

import numpy as np

from benchmarks.tornado.cases import Case
from benchmarks.tornado.outcome import Outcome, Verdict
from cellctl.version import software
from fakes.demo.processes.deck_to_frame import LIMITED, rotations
from tests.rigs.mating.cell import MatingCell
from tests.rigs.mating.trial import Trial, run_trial

STIFFNESS_N_M = 3e6
"""The stiffest contact of the scenario: forces grow fastest."""
STOP_LATENCY_MS = 250.0


def run_mating(case: Case) -> Outcome:
    """Run a mating that begins exactly above its seat."""
    cells: list[MatingCell] = []
    begun = time.monotonic()
    trial = run_trial(
        Trial(case.key, case.seed, STIFFNESS_N_M, STOP_LATENCY_MS),
        prepare=cells.append,
        special={"left": np.zeros(6), "imperfections": case.scales()},
    )
    truth = cells[0].world.report()
    pose = truth["frame_T_deck_mm_deg"]
    figures = {
        "lateral_mm": max(pin["offset_mm"] for pin in truth["pins"].values()),
        **rotations(pose),
        "seat_gap_mm": pose[2] - truth["deck_thickness_mm"],
        "peak_true_n": trial.true_peak_n,
        "final_true_n": truth["contact_force_n"],
    }
    beyond = [
        one.name for one in LIMITED if one.key in figures and not one.within(figures[one.key])
    ]
    verdict = Verdict.NOTICED
    if trial.complete:
        verdict = Verdict.NOT_NOTICED if beyond else Verdict.GOOD
    return Outcome(
        case=case,
        verdict=verdict,
        text=", ".join(beyond) if trial.complete else trial.text,
        lateral_mm=figures["lateral_mm"],
        rotation_deg=figures["rotation_deg"],
        seat_gap_mm=figures["seat_gap_mm"],
        peak_n=figures["peak_true_n"],
        final_n=figures["final_true_n"],
        iterations=None,
        wall_s=time.monotonic() - begun,
        software=software(),
    )
