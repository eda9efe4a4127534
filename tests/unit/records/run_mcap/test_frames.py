"""Reports that do not say where a robot was: they have no place in the tree of frames."""

import json
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

from cellctl.records.files.mcap_reading import RawMessage
from cellctl.records.run_mcap.frames import WRITTEN, reported_transforms, robot_frames
from cellctl.records.store import RunStore
from tests.unit.records.run_mcap.moved_run import PLACE, open_run

UNKNOWN = (None,) * 6


def report(time_ns: int, place: Sequence[float | None]) -> RawMessage:
    values = dict(zip(WRITTEN, place, strict=True))
    return RawMessage("/robots/main/report", time_ns, json.dumps(values).encode())


def test_a_report_without_a_place_makes_no_transform() -> None:
    reports = [report(1, PLACE), report(2, UNKNOWN), report(3, PLACE)]
    assert [one.time_ns for one in reported_transforms(reports, "base", "flange")] == [1, 3]


def test_a_robot_that_has_not_said_where_it_was_is_not_the_one_of_the_record(
    tmp_path: Path,
) -> None:
    with closing(RunStore(tmp_path)) as store:
        record = store.run(open_run(store))
    frames = robot_frames(record, {"aux_1": [report(1, UNKNOWN)], "main": [report(1, PLACE)]})
    assert frames["main"] == ("base", "flange")
    assert frames["aux_1"] == ("aux_1/base", "aux_1/flange")
