"""Runs are found by what is known of them, as fast in a store of years as in one of a day."""

from dataclasses import asdict
from datetime import datetime, timedelta
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cellctl.records import RunResult, RunStore
from cellctl.records.run_filter import OPEN, RunFilter
from cellctl.records.run_list import listed_runs
from tests.rigs.sweeps import examples
from tests.unit.records.conftest import start


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three runs: 1 good, 2 ended by F304 with an alarm 207 before, 3 open."""
    folder = tmp_path_factory.mktemp("store")
    store = RunStore(folder)
    store.close_run(start(store, "SAT-0042"), RunResult.GOOD)
    second = start(store, "SAT-0042%")
    store.add_alarm(second, 207, "F207 late")
    store.close_run(second, RunResult.ABORTED, fault_number=304, fault="F304 it did not stop")
    start(store, "sat-0042_3")
    store.close()
    return folder


def numbers(folder: Path, wanted: RunFilter) -> list[int]:
    return [one.head.number for one in listed_runs(folder, 9, wanted)]


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        (RunFilter(), [3, 2, 1]),
        (RunFilter(before=3), [2, 1]),
        (RunFilter(serial="SAT-0042"), [1]),
        (RunFilter(serial_begins="SAT-0042"), [2, 1]),
        # What means something in a pattern of SQL is a letter like any other.
        (RunFilter(serial_begins="%"), []),
        (RunFilter(serial_begins="SAT_0042"), []),
        (RunFilter(result=OPEN), [3]),
        (RunFilter(result="good"), [1]),
        (RunFilter(fault=304), [2]),
        (RunFilter(fault=207), [2]),
        (RunFilter(recipe="panel 500 x 1000", operator="OP-7"), [3, 2, 1]),
        (RunFilter(operator="OP-8"), []),
        (RunFilter(mode="production"), [3, 2, 1]),
        (RunFilter(mode="dry run"), []),
        (RunFilter(calibration="ef" * 32, result="good"), [1]),
        (RunFilter(calibration="ef"), []),
    ],
)
def test_all_conditions_hold(folder: Path, wanted: RunFilter, found: list[int]) -> None:
    assert numbers(folder, wanted) == found


def test_times_are_compared_as_instants(folder: Path) -> None:
    first, second, _ = sorted(one.head.started for one in listed_runs(folder, 9))
    there = first.astimezone(tz=datetime.now().astimezone().tzinfo)
    assert numbers(folder, RunFilter(until=there)) == []
    assert numbers(folder, RunFilter(since=there, until=second)) == [1]
    assert numbers(folder, RunFilter(since=first + timedelta(days=1))) == []


@given(
    words=st.fixed_dictionaries(
        {
            name: st.text(max_size=30)
            for name in ("serial", "serial_begins", "recipe", "operator", "result", "calibration")
        }
    )
)
@settings(max_examples=examples(50))
def test_no_text_is_sql(folder: Path, words: dict[str, str]) -> None:
    wanted = RunFilter(**words)  # type: ignore[arg-type]  # all of these are texts
    every = listed_runs(folder, 9)
    begins, result = words["serial_begins"], words["result"]
    for one in every:
        head = one.head
        holds = (
            words["serial"] in ("", head.serial)
            and head.serial.startswith(begins)
            and words["recipe"] in ("", head.recipe_name)
            and words["operator"] in ("", head.operator)
            and result in ("", head.result or OPEN)
            and (not words["calibration"] or words["calibration"] in head.calibration_ids.values())
        )
        assert (head.number in numbers(folder, wanted)) == holds, asdict(wanted)
