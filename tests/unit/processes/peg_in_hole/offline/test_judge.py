"""Recorded insertions of many cells, tasks and ways of writing, judged from their files."""

import io
import json
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap.writer import Writer

from cellctl.errors import CellError
from cellctl.errors.config import FileInvalid
from cellctl.errors.records.store import RecordingUnreadable
from cellctl.processes.peg_in_hole.faults import PegCurveInvalid
from cellctl.processes.peg_in_hole.offline.curve import parse_curve
from cellctl.processes.peg_in_hole.offline.judge import judge_by_task, judge_curve
from cellctl.processes.peg_in_hole.offline.task_file import JudgedPart, parse_part
from cellctl.processes.peg_in_hole.verdict.judgement import PegJudgement, PegVerdict
from tests.rigs.insertion.curves import NAMES, TASK, Inserted, as_csv, inserted
from tests.rigs.sweeps import sweep

GOOD = Inserted()
KEYED = replace(GOOD, turn_n_m=(0.6, -0.6), pull_n=9.0)


def part(made: Inserted = GOOD, **changed: Any) -> JudgedPart:
    fit = {
        "peg_radius_mm": 3.0,
        "clearance_mm": made.play_mm / 2,
        "hole_chamfer_mm": 0.5,
        "peg_chamfer_mm": 0.5,
        "depth_mm": made.hole_mm,
    }
    seat = {"least_n": 5.0, "most_n": 30.0, "grip_n": 60.0}
    if made.turn_n_m:
        fit["keys"] = {"depth_mm": 4.0, "window_deg": 1.0, "uncertainty_deg": 2.0}  # type: ignore[assignment]
    if made.pull_n is not None:
        seat["pull_n"] = 8.0
    content = {
        "fit": fit,
        "seat": seat,
        "cell": {"stiffness_n_mm": made.stiffness_n_mm, "force_sigma_n": 0.1},
    }
    return JudgedPart.model_validate(content | changed)


def judged(made: Inserted, *, named: bool = True, told: JudgedPart | None = None) -> PegJudgement:
    rows, kinds = inserted(made)
    curve = parse_curve(as_csv(rows, kinds if named else None))
    return judge_curve(curve, told or part(made))[1]


CELLS = (
    GOOD,
    KEYED,
    replace(GOOD, stiffness_n_mm=1000.0, play_mm=0.04),
    replace(GOOD, stiffness_n_mm=40.0, hole_mm=5.0, play_mm=0.3),
    replace(GOOD, interval_s=0.001, noise_n=0.3),
    replace(GOOD, interval_s=0.05, hole_mm=40.0),
)


@pytest.mark.parametrize(
    ("made", "named"),
    sweep(product(CELLS, (True, False)), ((CELLS[0], True), (CELLS[0], False), (CELLS[-1], True))),
)
def test_an_inserted_peg_is_inserted_in_every_cell(made: Inserted, named: bool) -> None:
    judgement = judged(made, named=named)
    assert judgement.verdict is PegVerdict.INSERTED, [str(check) for check in judgement.checks]


BAD = (
    (replace(GOOD, stands_mm=6.0), 592),
    (replace(GOOD, stands_mm=11.6), 592),
    (replace(GOOD, stands_mm=13.0), 592),
    (replace(GOOD, walls=()), 593),
    (replace(GOOD, walls=("+x", "+y", "-y")), 593),
    (replace(GOOD, lift_by_mm=0.2), 593),
    (replace(GOOD, seat_n=3.0), 592),
    (replace(KEYED, turn_n_m=(0.6, 0.1)), 595),
    (replace(KEYED, pull_n=1.0), 595),
)


@pytest.mark.parametrize("named", sweep((True, False), (True,)))
@pytest.mark.parametrize(("made", "fault"), BAD)
def test_what_is_not_inserted_is_named(made: Inserted, fault: int, named: bool) -> None:
    judgement = judged(made, named=named)
    assert judgement.verdict is PegVerdict.NOT_INSERTED
    assert judgement.fault is not None
    assert judgement.fault.number == fault, [str(check) for check in judgement.checks]


@pytest.mark.parametrize("named", [True, False])
def test_a_wider_hole_is_another_one(named: bool) -> None:
    wide = replace(GOOD, play_mm=0.4)
    judgement = judged(wide, named=named, told=part(GOOD))
    assert judgement.fault is not None
    assert judgement.fault.number == 594


@pytest.mark.parametrize("named", sweep((True, False), (True,)))
@pytest.mark.parametrize("pushed", [(), ("+x", "-x"), ("+x", "-x", "+y")])
def test_what_was_not_pushed_is_unknown(pushed: tuple[str, ...], named: bool) -> None:
    judgement = judged(replace(GOOD, pushed=pushed), named=named)
    assert judgement.verdict is PegVerdict.UNKNOWN
    assert not judgement.inserted


@pytest.mark.parametrize("named", [True, False])
def test_a_turn_that_was_not_made_and_a_grip_that_nobody_knows_are_unknown(named: bool) -> None:
    unturned = replace(KEYED, turn_n_m=())
    assert judged(unturned, named=named, told=part(KEYED)).verdict is not PegVerdict.INSERTED
    nobody = part(GOOD, seat={"least_n": 5.0, "most_n": 30.0})
    judgement = judged(GOOD, named=named, told=nobody)
    assert judgement.verdict is PegVerdict.UNKNOWN
    assert judgement.fault is not None
    assert judgement.fault.number == 591


def test_the_force_before_the_curve_counts() -> None:
    judgement = judged(GOOD, told=part(GOOD, felt={"greatest_n": 40.0}))
    assert judgement.fault is not None
    assert judgement.fault.number == 591


@pytest.mark.parametrize("named", sweep((True, False), (True,)))
@pytest.mark.parametrize(
    ("names", "factors"),
    [
        (("t_ms", "x_um", "y_um", "z_um", *NAMES[4:]), (1e3, 1e3, 1e3, 1e3, 1, 1, 1, 1, 1, 1)),
        (
            ("time_s", "x_m", "y_m", "height_m", "fx_n", "fy_n", "fz_n", "mx_nmm", "my_nmm",
             "mz_n_mm"),
            (1, 1e-3, 1e-3, -1e-3, 1, 1, -1, 1e3, 1e3, -1e3),
        ),
    ],
)  # fmt: skip
def test_other_units_and_a_height_say_the_same(
    names: tuple[str, ...], factors: tuple[float, ...], named: bool
) -> None:
    rows, kinds = inserted(KEYED)
    usual = judge_curve(parse_curve(as_csv(rows, kinds if named else None)), part(KEYED))[1]
    data = as_csv(rows * np.array(factors), kinds if named else None, names)
    other = judge_curve(parse_curve(data), part(KEYED))[1]
    assert other.verdict is PegVerdict.INSERTED
    for mine, theirs in zip(usual.checks, other.checks, strict=True):
        assert theirs.value == pytest.approx(mine.value, rel=1e-3, abs=1e-3)


@pytest.mark.parametrize("named", [True, False])
def test_forces_on_the_hole_are_taken_as_such_or_refused(named: bool) -> None:
    rows, kinds = inserted(GOOD)
    rows[:, 4:] *= -1
    data = as_csv(rows, kinds if named else None)
    with pytest.raises(PegCurveInvalid, match="force_on"):
        judge_curve(parse_curve(data), part())
    turned = parse_curve(data, force_on_hole=True)
    assert judge_curve(turned, part())[1].inserted


@pytest.mark.parametrize("named", [True, False])
def test_a_side_with_another_sign_is_refused(named: bool) -> None:
    rows, kinds = inserted(GOOD)
    rows[:, NAMES.index("fx_n")] *= -1
    with pytest.raises(PegCurveInvalid, match="fx"):
        judge_curve(parse_curve(as_csv(rows, kinds if named else None)), part())


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize(("factor", "words"), [(-1.0, "height"), (1e3, "another unit")])
def test_depths_that_cannot_be_are_refused(factor: float, words: str, named: bool) -> None:
    rows, kinds = inserted(GOOD)
    rows[:, NAMES.index("depth_mm")] *= factor
    with pytest.raises(PegCurveInvalid, match=words):
        judge_curve(parse_curve(as_csv(rows, kinds if named else None)), part())


def test_times_in_another_unit_are_refused() -> None:
    rows, kinds = inserted(GOOD)
    rows[:, 0] *= 1e3
    with pytest.raises(PegCurveInvalid, match="between samples"):
        parse_curve(as_csv(rows, kinds))
    with pytest.raises(PegCurveInvalid, match="falls"):
        parse_curve(as_csv(rows[::-1], kinds))


@pytest.mark.parametrize("named", sweep((True, False), (True,)))
@pytest.mark.parametrize(
    ("columns", "factor", "said"),
    [
        ("depth_mm", 1e-3, "depth_mm stays within 0.01"),
        ("fx_n fy_n fz_n", 1e-3, "fx_n, fy_n, fz_n: at most 0.01"),
        ("fx_n fy_n fz_n", 1e3, "fx_n, fy_n, fz_n: up to"),
        ("fy_n", 0.0, "fy_n is 0 in all"),
        ("time_s", 1.5e-3, "time_s: by it the part went in at"),
    ],
)
def test_numbers_in_another_unit_are_refused_with_their_column(
    columns: str, factor: float, said: str, named: bool
) -> None:
    rows, kinds = inserted(GOOD)
    rows[:, [NAMES.index(name) for name in columns.split()]] *= factor
    with pytest.raises(PegCurveInvalid, match=said):
        judge_curve(parse_curve(as_csv(rows, kinds if named else None)), part())


@pytest.mark.parametrize("name", NAMES[:7])
def test_a_missing_column_is_named(name: str) -> None:
    rows, _ = inserted(GOOD)
    index = NAMES.index(name)
    kept = [one for one in NAMES if one != name]
    with pytest.raises(PegCurveInvalid, match=name.partition("_")[0]):
        parse_curve(as_csv(np.delete(rows, index, axis=1), None, kept))


def test_without_moments_a_round_part_is_judged_and_a_keyed_one_unknown() -> None:
    rows, kinds = inserted(KEYED)
    bare = parse_curve(as_csv(rows[:, :7], kinds, NAMES[:7]))
    assert judge_curve(bare, part(KEYED))[1].verdict is PegVerdict.UNKNOWN
    rows, kinds = inserted(GOOD)
    assert judge_curve(parse_curve(as_csv(rows[:, :7], kinds, NAMES[:7])), part())[1].inserted


def test_empty_lines_are_no_samples() -> None:
    rows, kinds = inserted(GOOD)
    written = as_csv(rows, kinds)
    assert len(parse_curve(written + b"\n\r\n").samples) == len(parse_curve(written).samples)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda text: text.replace("depth_mm", "depth_inch", 1), "no unit"),
        (lambda text: text.replace("depth_mm", "depth", 1), "no unit"),
        (lambda text: text.replace("mx_nm", "depth_um", 1), "the same"),
        (lambda text: text.replace("mx_nm", "height_mm", 1), "contradict"),
        (lambda text: text.replace(",kind", ",remark", 1), "companion"),
        (lambda text: text.replace(",feed", ",fed", 1), "kinds are"),
        (lambda text: text.replace("\n0.01,", "\nnan,", 1), "time_s is"),
        (lambda text: text.replace("\n0.01,", "\n0.01,1,", 1), "values for"),
        (lambda text: "\n".join(text.splitlines()[:5]), "at least"),
        (lambda _text: "", "missing column"),
    ],
)
def test_what_is_wrong_with_a_file_is_named(change: Any, words: str) -> None:
    rows, kinds = inserted(GOOD)
    text = as_csv(rows, kinds).decode()
    with pytest.raises(PegCurveInvalid, match=words):
        parse_curve(change(text).encode())


def as_mcap(rows: Any, names: tuple[str, ...] = NAMES, topic: str = "/contact") -> bytes:
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    schema = writer.register_schema("curve", "jsonschema", b"{}")
    channel = writer.register_channel(topic, "json", schema)
    for row in rows:
        values = dict(zip(names, row.tolist(), strict=True))
        writer.add_message(channel, 0, json.dumps(values).encode(), 0)
    writer.finish()
    return stream.getvalue()


def test_an_mcap_file_says_the_same_and_a_cut_off_one_is_refused() -> None:
    rows, _ = inserted(GOOD)
    data = as_mcap(rows)
    assert judge_curve(parse_curve(data), part())[1].inserted
    with pytest.raises((PegCurveInvalid, RecordingUnreadable)):
        parse_curve(data[: len(data) * 2 // 3])
    with pytest.raises(PegCurveInvalid, match="topic /contact: missing column"):
        parse_curve(as_mcap(rows[:, :3], NAMES[:3]))


@given(st.binary(max_size=400))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    head = ",".join(NAMES).encode() + b"\n"
    for file in (data, head + data, b"\x89MCAP0\r\n" + data):
        with pytest.raises((PegCurveInvalid, RecordingUnreadable)):
            parse_curve(file)


@given(
    st.lists(st.tuples(*[st.floats(-1e9, 1e9)] * 9), min_size=20, max_size=40),
    st.booleans(),
)
def test_any_numbers_are_judged_or_refused(rows: list[tuple[float, ...]], keyed: bool) -> None:
    times = np.arange(len(rows)) * 0.01
    curve = parse_curve(as_csv(np.column_stack([times, np.array(rows)])))
    try:
        judgement = judge_curve(curve, part(KEYED if keyed else GOOD))[1]
    except PegCurveInvalid:
        return
    assert not judgement.inserted


def test_a_task_is_read_from_toml_json_and_the_record_of_a_run(tmp_path: Path) -> None:
    told = parse_part(TASK)
    content = told.model_dump(mode="json")
    assert parse_part(json.dumps(content), as_json=True) == told
    run = {"documents": [{"key": "insertion.task", "content": content}]}
    assert parse_part(json.dumps(run), as_json=True) == told
    rows, kinds = inserted(GOOD)
    (tmp_path / "c.csv").write_bytes(as_csv(rows, kinds))
    (tmp_path / "run.json").write_text(json.dumps(run))
    found = judge_by_task(tmp_path / "c.csv", tmp_path / "run.json")
    assert found.good
    assert found.fault is None
    json.dumps(found.record, allow_nan=False)
    with pytest.raises(PegCurveInvalid, match=r"no\.csv"):
        judge_by_task(tmp_path / "no.csv", tmp_path / "run.json")
    with pytest.raises(FileInvalid, match=r"no\.toml"):
        judge_by_task(tmp_path / "c.csv", tmp_path / "no.toml")


@pytest.mark.parametrize(
    ("figure", "factor", "words"),
    [
        ("seat_force_n", 1.0, None),
        ("seat_force_n", 3.0, "seat force is .* N, that of the run in the task .* N"),
        ("depth_m", 1.02, "depth of the seat is .* mm, that of the run in the task .* mm"),
    ],
)
def test_a_curve_of_another_run_is_not_judged_by_this_task(
    tmp_path: Path, figure: str, factor: float, words: str | None
) -> None:
    rows, kinds = inserted(GOOD)
    curve, task = tmp_path / "c.csv", tmp_path / "run.json"
    curve.write_bytes(as_csv(rows, kinds))
    told = {"key": "insertion.task", "content": part().model_dump(mode="json")}
    task.write_text(json.dumps({"documents": [told]}))
    evidence = dict(judge_by_task(curve, task).record["evidence"])
    evidence[figure] *= factor
    result = {"key": "insertion.result", "content": {"evidence": evidence}}
    task.write_text(json.dumps({"documents": [told, result]}))
    if words is None:
        assert judge_by_task(curve, task).good
        return
    with pytest.raises(PegCurveInvalid, match=words):
        judge_by_task(curve, task)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (TASK.replace("depth_mm = 12.0", ""), "depth_mm"),
        (TASK.replace("depth_mm = 12.0", "depth_mm = -1"), "depth_mm"),
        (TASK + "stiff = 3", "stiff"),
        ("[fit", "TOML"),
    ],
)
def test_a_task_that_is_wrong_is_refused_with_its_place(text: str, words: str) -> None:
    with pytest.raises(FileInvalid, match=words):
        parse_part(text)


@given(st.text(max_size=60), st.booleans())
def test_any_text_is_no_task(text: str, as_json: bool) -> None:
    with pytest.raises(CellError):
        parse_part(text, as_json=as_json)


def test_a_run_without_an_insertion_has_nothing_to_judge() -> None:
    with pytest.raises(FileInvalid, match=r"insertion\.task"):
        parse_part(json.dumps({"documents": [{"key": "search.map"}]}), as_json=True)
