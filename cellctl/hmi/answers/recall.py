"""Recall both ways: which parts a calibration has touched, and what stands behind a part."""

from collections.abc import Mapping, Sequence
from typing import Any

from cellctl.hmi.answers.calibrations import CalibrationTold, CellCalibrations
from cellctl.hmi.answers.form import Form, Time
from cellctl.records.entered.gauges import part_verdict
from cellctl.records.entries import Calibration, RunHead, RunRecord
from cellctl.records.outcome import outcome
from cellctl.records.parts import mate_serial
from cellctl.records.run_list import ListedRun
from cellctl.translations import spoken


class RunTold(Form):
    """The head of a run."""

    number: int
    process: str
    serial: str
    recipe: str
    mode: str
    operator: str
    simulated: bool
    started: Time
    ended: Time | None
    ended_as: str
    """In the words of lists, such as `good`, or `good, bad by gauge`."""


class CalibrationRecall(Form):
    """The runs that used a calibration."""

    calibration: CalibrationTold | None
    """Null where only the runs name it and the records do not have it."""
    runs: tuple[RunTold, ...]
    """The newest first."""
    serials: tuple[str, ...]
    """Serial numbers of these runs, each once: the parts to look at."""
    more: bool
    """There are older runs: ask again with `before` as the last number of this answer."""


class UsedCalibration(Form):
    """A calibration that a run used."""

    name: str
    """What the run used it for."""
    id: str
    kept: CalibrationTold | None
    """As the records have it today; null where they do not have it."""


class RunBehind(RunTold):
    """A run of the part, with what its result rests on; `/runs/{number}` has all the rest."""

    joined_to: str
    """Serial number of the other part of this run; empty where nobody has named one."""
    fault: str | None
    software: str
    recipe_hash: str
    config_hash: str
    """Hash of the cell file."""
    as_sealed: bool | None
    """The run is as it was sealed; null while it is open."""
    calibrations: tuple[UsedCalibration, ...]


class SerialRecall(Form):
    """What stands behind a serial number."""

    serial: str
    runs: tuple[RunBehind, ...]
    """Runs of this part and those of parts that were joined to it, the newest first."""


def calibration_recall(
    found: Sequence[ListedRun], kept: CalibrationTold | None, *, more: bool
) -> CalibrationRecall:
    """Which runs used a calibration."""
    runs = tuple(RunTold(**_head(one.head, spoilt=one.spoilt)) for one in found)
    serials = tuple(dict.fromkeys(one.serial for one in runs))
    return CalibrationRecall(calibration=kept, runs=runs, serials=serials, more=more)


def run_behind(
    record: RunRecord,
    kept: Mapping[str, Calibration],
    cell: CellCalibrations,
    language: str,
    *,
    as_sealed: bool | None,
) -> RunBehind:
    """A run of a part; ``kept`` are the calibrations of the records by identity."""
    head = record.head
    used = tuple(
        UsedCalibration(
            name=name, id=identity, kept=cell.told(kept[identity]) if identity in kept else None
        )
        for name, identity in head.calibration_ids.items()
    )
    return RunBehind(
        **_head(head, spoilt=part_verdict(record) != head.result),
        joined_to=mate_serial(record),
        fault=head.fault and spoken(head.fault, language),
        software=head.software,
        recipe_hash=head.recipe_hash,
        config_hash=head.config_hash,
        as_sealed=as_sealed,
        calibrations=used,
    )


def _head(head: RunHead, *, spoilt: bool) -> dict[str, Any]:
    return {
        "number": head.number,
        "process": head.process,
        "serial": head.serial,
        "recipe": head.recipe_name,
        "mode": head.mode,
        "operator": head.operator,
        "simulated": head.simulated,
        "started": head.started,
        "ended": head.ended,
        "ended_as": outcome(head.mode, head.result, spoilt=spoilt),
    }
