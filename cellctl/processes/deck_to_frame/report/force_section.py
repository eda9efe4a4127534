"""The mating under force: every recorded contact with its curve and its statistics."""

from collections.abc import Iterator, Sequence
from pathlib import PurePosixPath

import numpy as np

from cellctl.errors.records.store import RecordingUnreadable
from cellctl.force.contact.curve import FINAL_S, ForceCurve, curve_statistics
from cellctl.processes.deck_to_frame.record.keys import LIMIT_FORCE, TARGET_FORCE
from cellctl.processes.deck_to_frame.report.force_plot import force_by_time, force_by_travel
from cellctl.records.entries import RunRecord
from cellctl.records.files.curve_file import Recording, is_curve, read_recording
from cellctl.records.report.sections import (
    Drawing,
    FactList,
    Heading,
    ReadArtefact,
    ReportBlock,
    ReportSection,
)
from cellctl.records.units import words


def recordings(record: RunRecord, read: ReadArtefact) -> dict[str, Recording]:
    """The curves of a run by the names of their files, as far as they can be read."""
    found = {}
    for artefact in record.artefacts:
        if not is_curve(artefact):
            continue
        try:
            found[artefact.name] = read_recording(read(artefact))
        except RecordingUnreadable:
            # The file is exported as it is and listed with its hash; there is nothing to draw.
            continue
    return found


def force_section(record: RunRecord, curves: dict[str, Recording]) -> ReportSection:
    """Drawings and statistics of every contact."""
    blocks = (block for name, curve in curves.items() for block in _contact(name, curve, record))
    return ReportSection("Mating under force", tuple(blocks))


def _contact(name: str, recording: Recording, record: RunRecord) -> Iterator[ReportBlock]:
    curve = recording.curve
    target_n, limit_n = record.value(TARGET_FORCE), record.value(LIMIT_FORCE)
    title = words(PurePosixPath(name).stem.replace("-", "_"))
    cut = not recording.complete
    yield Heading(title, "recording cut off" if cut else "", warning=cut)
    by_time = force_by_time(curve, target_n, limit_n)
    yield Drawing(by_time, "Force on the deck over time, deck frame, gravity removed.")
    if np.isfinite(curve.travel_m).any():
        by_travel = force_by_travel(curve, target_n, limit_n)
        yield Drawing(by_travel, "Force along the approach over travel.")
    yield FactList(tuple(_statistics(curve)))


def _statistics(curve: ForceCurve) -> Sequence[tuple[str, str]]:
    if len(curve.time_s) < 2:
        return [("samples", str(len(curve.time_s)))]
    figures = curve_statistics(curve.time_s, curve.wrench)
    return [
        ("samples", f"{figures.samples} at {figures.rate_hz:.0f} Hz"),
        ("duration", f"{figures.duration_s:.2f} s"),
        ("peak Fz, every sample", f"{figures.peak_fz_n:.2f} N"),
        ("peak Fz, mean of 5 ms", f"{figures.peak_filtered_fz_n:.2f} N"),
        ("peak lateral force", f"{figures.peak_lateral_n:.2f} N"),
        ("peak moment", f"{figures.peak_moment_n_m:.2f} N·m"),
        ("final Fz", f"{figures.final[2]:.2f} N, mean of the last {FINAL_S:g} s"),
        # No uncertainty of the force, which would have that of the sensor in it: none is known.
        (
            "scatter of the samples in that time",
            f"{figures.final_sigma[2]:.2f} N, one standard deviation; it says nothing of how true "
            "the sensor is",
        ),
    ]
