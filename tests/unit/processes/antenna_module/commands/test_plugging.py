"""The commands from files: results, and every mistake by its name."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer
from scipy.spatial.transform import RigidTransform
from typer.testing import CliRunner

from cellctl.cli.offline.judge_insertion import judge_insertion
from cellctl.errors import CellError
from cellctl.errors.calibration import WristConfigurationsDiffer
from cellctl.errors.config import FileInvalid
from cellctl.processes.antenna_module.commands import plugging as commands
from cellctl.processes.antenna_module.faults.calibration import (
    TeachScatter,
    TooFewTeachings,
    TurnInvalid,
)
from cellctl.processes.antenna_module.faults.connector import ConnectorFileInvalid
from cellctl.processes.antenna_module.faults.plugging import (
    CalibrationsDoNotBelongTogether,
    InsertionCurveInvalid,
    OutOfTaughtRange,
    StaleLook,
)
from tests.rigs.antenna import exact_cell as exact
from tests.rigs.antenna.curves import Shape, as_csv, curve
from tests.rigs.antenna.plugging_files import Json, cell_entries, look_entries, mm, teach_content

DRAWING = "config/connectors/micro-d-15-pins.toml"
SOCKET = "config/connectors/micro-d-15-holes.toml"


def application() -> typer.Typer:
    app = typer.Typer()
    commands.add_plan_plug(app)
    app.command("judge-insertion")(judge_insertion)
    commands.add_calibrate_plug(app)
    commands.add_calibrate_tool_turn(app)
    return app


def run(*words: str) -> Any:
    return CliRunner().invoke(application(), words)


@pytest.fixture(scope="module")
def correction(tmp_path_factory: pytest.TempPathFactory) -> Json:
    folder = tmp_path_factory.mktemp("teach")
    out = folder / "correction.json"
    picture = folder / "correction.png"
    result = run(
        "plug", "--in", written(folder, teach_content()), "--out", str(out),
        "--picture", str(picture),
    )  # fmt: skip
    assert result.exit_code == 0, result.exception
    assert picture.read_bytes().startswith(b"\x89PNG")
    content: Json = json.loads(out.read_text())
    return content


def written(folder: Path, content: Json) -> str:
    path = folder / "in.json"
    path.write_text(json.dumps(content))
    return str(path)


def test_a_correction_is_checked_with_plugs_that_it_was_not_taught_with(tmp_path: Path) -> None:
    content = teach_content()
    further = content["plugs"].pop()
    good = run("plug", "--in", written(tmp_path, {**content, "checked_plugs": [further]}))
    assert good.exit_code == 1, "three plugs are too few"
    content["plugs"].append(further)
    checked = {key: value for key, value in further.items() if key != "name"}
    good = run("plug", "--in", written(tmp_path, {**content, "checked_plugs": [checked]}))
    assert good.exit_code == 0, good.output
    assert "checked plug 1: offset" in good.output
    aside = RigidTransform.from_translation([2e-4, 0.0, 0.0])
    moved = mm(aside * exact.taught_plugs()[-1].base_T_flange)
    wrong = {**checked, "plugged_base_T_flange": moved}
    bad = run("plug", "--in", written(tmp_path, {**content, "checked_plugs": [wrong]}))
    assert bad.exit_code == 3
    assert "FAIL  checked plug 1: offset" in bad.output


def trial_content(correction: Json) -> Json:
    return {**cell_entries(), "looks": look_entries(exact.looks()), "correction": correction}


def test_a_plan_from_files(tmp_path: Path, correction: Json) -> None:
    out = tmp_path / "plan.json"
    (tmp_path / "correction.json").write_text(json.dumps(correction))
    content = {
        **trial_content(correction),
        "correction": "correction.json",
        "connector": str(Path(DRAWING).absolute()),
    }
    result = run("plan-plug", "--in", written(tmp_path, content), "--out", str(out))
    assert result.exit_code == 0, result.exception
    assert "99 % within" in result.output
    plan = json.loads(out.read_text())
    assert 20 < plan["p99_um"] < 50
    np.testing.assert_allclose(
        plan["base_T_flange"]["xyz_abc_mm_deg"][:3], mm(exact.TARGET)[:3], atol=1e-3
    )
    assert set(plan["terms_um"]) >= {
        "look_plug", "look_socket", "approach", "correction", "drift",
    }  # fmt: skip


def exchanged_intrinsics(content: Json) -> None:
    content["looks"][0]["measurement"]["camera_id"] = "camera 2, newer"


def exchanged_everywhere(content: Json) -> None:
    content["cameras"]["cam2"] = "camera 2, newer"


def foreign_correction(content: Json) -> None:
    content["gripper"] = "gripper 4"


def newer_hand_eye(content: Json) -> None:
    content["flange_T_cam1"]["flange_T_camera"]["matrix_mm"][0][3] += 0.01


def old_look(content: Json) -> None:
    content["time_s"] = 500.0


def mixed_wrists(content: Json) -> None:
    content["looks"][1]["joints_deg"][4] *= -1


def far_slot(content: Json) -> None:
    content["looks"][1]["base_T_flange"][1] += 300


def other_setup(content: Json) -> None:
    content["base_T_cam2"] = content["flange_T_cam1"]


def two_plugs(content: Json) -> None:
    content["looks"].append(content["looks"][0])


def five_joints(content: Json) -> None:
    content["looks"][0]["joints_deg"].pop()


def unknown_scheme(content: Json) -> None:
    content["scheme"] = "guess"


def wrong_connector(content: Json) -> None:
    content["looks"][0]["measurement"]["connector"] = "da-15"


def wrong_socket(content: Json) -> None:
    content["looks"][1]["measurement"]["connector"] = "da-15"


def no_such_file(content: Json) -> None:
    content["correction"] = "nowhere.json"


@pytest.mark.parametrize(
    ("spoil", "fault"),
    [
        (exchanged_intrinsics, CalibrationsDoNotBelongTogether),
        (exchanged_everywhere, CalibrationsDoNotBelongTogether),
        (foreign_correction, CalibrationsDoNotBelongTogether),
        (newer_hand_eye, CalibrationsDoNotBelongTogether),
        (old_look, StaleLook),
        (mixed_wrists, WristConfigurationsDiffer),
        (far_slot, OutOfTaughtRange),
        (other_setup, FileInvalid),
        (two_plugs, FileInvalid),
        (five_joints, FileInvalid),
        (unknown_scheme, FileInvalid),
        (wrong_connector, FileInvalid),
        (wrong_socket, CalibrationsDoNotBelongTogether),
        (no_such_file, FileInvalid),
    ],
)
def test_a_mistake_in_a_trial_is_refused_by_name(
    tmp_path: Path, correction: Json, spoil: Callable[[Json], None], fault: type[CellError]
) -> None:
    content = json.loads(json.dumps(trial_content(correction)))
    spoil(content)
    result = run("plan-plug", "--in", written(tmp_path, content), "--connector", DRAWING)
    assert isinstance(result.exception, fault), result.exception


def exchanged_while_teaching(content: Json) -> None:
    content["plugs"][2]["looks"][1]["measurement"]["camera_id"] = "camera 1, newer"


def hand_eye_with_others(content: Json) -> None:
    content["base_T_cam2"]["camera_id"] = "camera 2, newer"


def two_connectors(content: Json) -> None:
    content["plugs"][1]["looks"][0]["measurement"]["connector"] = "da-15"


def looks_of_the_next_plug(content: Json) -> None:
    """Put the poses of the plugged flange one line off: grips differ from plug to plug."""
    plugs = content["plugs"]
    poses = [plug["plugged_base_T_flange"] for plug in plugs]
    for plug, pose in zip(plugs, [*poses[1:], poses[0]], strict=True):
        plug["plugged_base_T_flange"] = pose


@pytest.mark.parametrize(
    ("spoil", "fault", "words"),
    [
        (exchanged_while_teaching, CalibrationsDoNotBelongTogether, "camera I: measured with"),
        (hand_eye_with_others, CalibrationsDoNotBelongTogether, "hand-eye made with camera 2, n"),
        (two_connectors, CalibrationsDoNotBelongTogether, "different connectors"),
        (looks_of_the_next_plug, TeachScatter, "farthest from the mean: plug"),
    ],
)
def test_a_mistake_in_a_teaching_is_refused_by_name(
    tmp_path: Path, spoil: Callable[[Json], None], fault: type[CellError], words: str
) -> None:
    content = json.loads(json.dumps(teach_content()))
    spoil(content)
    out = tmp_path / "correction.json"
    result = run("plug", "--in", written(tmp_path, content), "--out", str(out))
    assert isinstance(result.exception, fault), result.exception
    assert words in str(result.exception)
    assert not out.exists()


def test_a_trial_without_a_drawing_is_refused(tmp_path: Path, correction: Json) -> None:
    result = run("plan-plug", "--in", written(tmp_path, trial_content(correction)))
    assert isinstance(result.exception, FileInvalid)


def test_too_few_taught_plugs_are_refused(tmp_path: Path) -> None:
    content = teach_content()
    del content["plugs"][3]
    result = run("plug", "--in", written(tmp_path, content))
    assert isinstance(result.exception, TooFewTeachings)


def test_a_turn_from_a_file(tmp_path: Path) -> None:
    turns = [
        {"a6_deg": angle, "position_mm": [3 + np.cos(np.radians(angle)), np.sin(np.radians(angle))]}
        for angle in range(0, 360, 90)
    ]
    out = tmp_path / "turn.json"
    result = run("tool-turn", "--in", written(tmp_path, {"turns": turns}), "--out", str(out))
    assert result.exit_code == 0, result.exception
    np.testing.assert_allclose(json.loads(out.read_text())["offset_mm"], [1, 0], atol=1e-9)
    few = run("tool-turn", "--in", written(tmp_path, {"turns": turns[:2]}))
    assert isinstance(few.exception, TurnInvalid)


@pytest.mark.parametrize(
    ("shape", "code", "verdict"),
    [(Shape(), 0, "seated"), (Shape(pin_n_per_mm=115, pin_mm=(-4.4, 0.5)), 3, "bent_pin")],
)
def test_an_insertion_is_judged_from_a_file(
    tmp_path: Path, shape: Shape, code: int, verdict: str
) -> None:
    (tmp_path / "c.csv").write_text(as_csv(curve(shape)))
    out = tmp_path / "verdict.json"
    result = run(
        "judge-insertion",
        "--curve", str(tmp_path / "c.csv"), "--connector", SOCKET, "--out", str(out),
    )  # fmt: skip
    assert result.exit_code == code, result.exception
    assert json.loads(out.read_text())["verdict"] == verdict


def test_the_plugs_drawing_does_not_name_the_contact_at_the_other_end(tmp_path: Path) -> None:
    path = tmp_path / "c.csv"
    path.write_text(as_csv(curve(Shape(pin_n_per_mm=115, pin_mm=(-4.4, 0.5)))))
    judged = run("judge-insertion", "--curve", str(path), "--connector", SOCKET)
    assert "contact 8 of the socket micro-d-15, by moments in its axes" in judged.output
    refused = run("judge-insertion", "--curve", str(path), "--connector", DRAWING)
    assert isinstance(refused.exception, ConnectorFileInvalid)
    assert "micro-d-15 has pins, not holes; give the socket's drawing" in str(refused.exception)
    assert "contact" not in refused.output


@pytest.mark.parametrize(
    ("column", "factor", "said"),
    [
        ("t_s", 1e3, "t_s: 4 s between samples"),
        ("t_s", 50.0, "t_s: by it the part went in at 0.008 mm/s"),
        ("t_s", 1e-3, "t_s: 4e-06 s between samples"),
        ("z_mm", 1e-3, "z_mm stays within 0.002"),
        ("z_mm", 1e3, "z_mm reaches 25"),
        ("f", 1e-3, "fx_n, fy_n, fz_n: at most 0.0"),
        ("f", 1e3, "fx_n, fy_n, fz_n: up to"),
        ("m", 1e3, "mx_n_m, my_n_m: the force would act"),
    ],
)
def test_numbers_in_another_unit_are_refused_with_their_column(
    tmp_path: Path, column: str, factor: float, said: str
) -> None:
    lines = as_csv(curve()).splitlines()
    names = lines[0].split(",")
    table = np.array([[float(one) for one in line.split(",")] for line in lines[1:]])
    table[:, [name.startswith(column) for name in names]] *= factor
    rows = [",".join(f"{one:.9g}" for one in row) for row in table]
    path = tmp_path / "c.csv"
    path.write_text("\n".join([lines[0], *rows]))
    result = run("judge-insertion", "--curve", str(path), "--connector", SOCKET)
    assert isinstance(result.exception, InsertionCurveInvalid)
    assert f"{path}: {said}" in str(result.exception)
    assert "another unit, such as" in str(result.exception)


@pytest.mark.parametrize(
    ("encoding", "said"),
    [("utf-8-sig", None), ("utf-16", "not UTF-8 (byte 1); save it as CSV in UTF-8")],
)
def test_an_encoding_is_read_or_named(tmp_path: Path, encoding: str, said: str | None) -> None:
    path = tmp_path / "c.csv"
    path.write_text(as_csv(curve()), encoding=encoding)
    result = run("judge-insertion", "--curve", str(path), "--connector", SOCKET)
    if said is None:
        assert result.exit_code == 0, result.exception
    else:
        assert isinstance(result.exception, InsertionCurveInvalid)
        assert said in str(result.exception)


def test_a_curve_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    result = run("judge-insertion", "--curve", str(tmp_path / "no.csv"), "--connector", SOCKET)
    assert isinstance(result.exception, InsertionCurveInvalid)
