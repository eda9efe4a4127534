import json
from pathlib import Path

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from cellctl.cli.offline.identify_payload import identify_payload
from cellctl.errors.force import PayloadFileInvalid, PosesDegenerate
from tests.rigs.payload_world import LoadedSensor, format_pose_file, imperfect, record

app = typer.Typer()
app.command()(identify_payload)


@pytest.fixture
def csv_file(tmp_path: Path) -> Path:
    rng = np.random.default_rng(31)
    path = tmp_path / "poses.csv"
    path.write_text(format_pose_file(record(imperfect(rng), rng)), encoding="utf-8")
    return path


def test_a_good_file_gives_a_result_and_a_picture(csv_file: Path, tmp_path: Path) -> None:
    out, picture = tmp_path / "payload.json", tmp_path / "residuals.png"
    arguments = [str(csv_file), "--out", str(out), "--picture", str(picture), "--mass-kg", "200"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    assert "accepted" in result.output
    document = json.loads(out.read_text(encoding="utf-8"))
    assert document["accepted"] is True
    assert document["rigid12"]["mass_kg"] == pytest.approx(200.0, rel=0.06)
    assert np.array(document["affine24"]["matrix"]).shape == (6, 3)
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_payload_that_fails_its_acceptance_is_written_and_exits_with_3(
    csv_file: Path, tmp_path: Path
) -> None:
    out = tmp_path / "payload.json"
    result = CliRunner().invoke(app, [str(csv_file), "--out", str(out), "--mass-kg", "250"])
    assert result.exit_code == 3
    assert "FAIL  mass against CAD" in result.output
    assert json.loads(out.read_text(encoding="utf-8"))["accepted"] is False


def test_faults_are_numbered(tmp_path: Path) -> None:
    missing = CliRunner().invoke(app, [str(tmp_path / "none.csv")])
    assert isinstance(missing.exception, PayloadFileInvalid)
    same = tmp_path / "same.csv"
    data = record(LoadedSensor(), np.random.default_rng(1))
    lines = format_pose_file(data).splitlines()
    same.write_text("\n".join([lines[0], *[lines[1]] * 12]), encoding="utf-8")
    degenerate = CliRunner().invoke(app, [str(same)])
    assert isinstance(degenerate.exception, PosesDegenerate)


def rewritten(csv_file: Path, factors: dict[str, float], order: str = "xyzw") -> Path:
    """The file with some columns in another unit, and quaternions in another order."""
    header, *rows = csv_file.read_text(encoding="utf-8").splitlines()
    names = header.split(",")
    lines = [header]
    for row in rows:
        fields = dict(zip(names, row.split(","), strict=True))
        turned = [fields[f"q{axis}"] for axis in order]
        fields |= dict(zip(("qx", "qy", "qz", "qw"), turned, strict=True))
        for name, factor in factors.items():
            fields[name] = repr(float(fields[name]) * factor)
        lines.append(",".join(fields[name] for name in names))
    path = csv_file.with_name("rewritten.csv")
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


FORCES, MOMENTS = ("fx_n", "fy_n", "fz_n"), ("mx_nm", "my_nm", "mz_nm")


@pytest.mark.parametrize(
    ("factors", "options", "said"),
    [
        (dict.fromkeys(FORCES, 1e-3), (), "forces look like kN"),
        (dict.fromkeys(FORCES + MOMENTS, 1e-3), ("--mass-kg", "200"), "forces look like kN"),
        (dict.fromkeys(FORCES, 1 / 9.80665), ("--mass-kg", "200"), "forces look like kgf"),
        (dict.fromkeys(MOMENTS, 1e3), (), "moments look like N·mm"),
        (dict.fromkeys(MOMENTS, 1e-3), (), "moments look like kN·m"),
    ],
)
def test_another_unit_is_named(
    csv_file: Path, factors: dict[str, float], options: tuple[str, ...], said: str
) -> None:
    result = CliRunner().invoke(app, [str(rewritten(csv_file, factors)), *options])
    assert f"note: {said}" in result.output
    assert "NOT accepted" in result.output
    assert result.exit_code == 3


def test_one_axis_with_the_other_sign_is_not_accepted(csv_file: Path) -> None:
    """Its weight is compensated all the same, and a contact would read as a pull."""
    result = CliRunner().invoke(app, [str(rewritten(csv_file, {"fz_n": -1.0})), "--mass-kg", "200"])
    assert result.exit_code == 3
    assert "FAIL  share of the offset that fz with the other sign explains" in result.output


@pytest.mark.parametrize(
    "written",
    [
        ("mz_nm", "my_nm", "mx_nm"),
        ("my_nm", "mx_nm", "mz_nm"),
        ("mx_nm", "mz_nm", "my_nm"),
        ("my_nm", "mz_nm", "mx_nm"),
    ],
)
def test_torques_of_exchanged_axes_are_not_accepted(
    csv_file: Path, written: tuple[str, str, str]
) -> None:
    """They are compensated all the same, and a contact would turn about another axis."""
    header, *rows = csv_file.read_text(encoding="utf-8").splitlines()
    header = header.replace("mx_nm,my_nm,mz_nm", ",".join(written))
    csv_file.write_text("\n".join([header, *rows]), encoding="utf-8")
    result = CliRunner().invoke(app, [str(csv_file), "--mass-kg", "200"])
    assert result.exit_code == 3
    assert "FAIL  share of the change of torques that no load explains" in result.output


@pytest.mark.parametrize("seed", range(5))
def test_cross_talk_is_no_exchange_of_axes(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    path = tmp_path / "poses.csv"
    path.write_text(format_pose_file(record(imperfect(rng), rng)), encoding="utf-8")
    output = CliRunner().invoke(app, [str(path)]).output
    assert "ok    share of the change of torques that no load explains" in output


def test_a_sensor_that_states_reactions_is_said_with_its_setting(csv_file: Path) -> None:
    turned = rewritten(csv_file, dict.fromkeys(FORCES + MOMENTS, -1.0))
    result = CliRunner().invoke(app, [str(turned), "--mass-kg", "200"])
    assert "a contact would read as a pull. Set 'inverted'" in result.output


def test_torques_with_the_other_sign_are_not_accepted(csv_file: Path, tmp_path: Path) -> None:
    """Every residual stays as small as it was; only the lever of the weight points up."""
    out = tmp_path / "payload.json"
    turned = rewritten(csv_file, dict.fromkeys(MOMENTS, -1.0))
    result = CliRunner().invoke(app, [str(turned), "--mass-kg", "200", "--out", str(out)])
    assert result.exit_code == 3
    assert "FAIL  share of the lever that points away from where the load is" in result.output
    assert "above the sensor" in result.output
    assert "the torques have the other sign" in result.output
    assert json.loads(out.read_text(encoding="utf-8"))["accepted"] is False


def test_a_load_on_top_of_its_sensor_has_to_be_stated(csv_file: Path) -> None:
    turned = str(rewritten(csv_file, dict.fromkeys(MOMENTS, -1.0)))
    stated = CliRunner().invoke(app, [turned, "--mass-kg", "200", "--load-on-top"])
    assert stated.exit_code == 0, stated.output
    wrong = CliRunner().invoke(app, [str(csv_file), "--mass-kg", "200", "--load-on-top"])
    assert wrong.exit_code == 3
    assert "below the sensor" in wrong.output


def test_reversed_torques_are_told_from_a_sensor_that_states_reactions(csv_file: Path) -> None:
    both = rewritten(csv_file, dict.fromkeys(FORCES + MOMENTS, -1.0))
    assert "the torques have" not in CliRunner().invoke(app, [str(both)]).output
    forces = rewritten(csv_file, dict.fromkeys(FORCES, -1.0))
    assert "the torques have" in CliRunner().invoke(app, [str(forces)]).output


def test_a_real_part_that_stands_first_is_named(csv_file: Path) -> None:
    result = CliRunner().invoke(app, [str(rewritten(csv_file, {}, "wxyz"))])
    assert result.exit_code != 0
    assert "the real part belongs last" in result.output + str(result.exception)


def test_a_mass_that_nobody_compared_is_said(csv_file: Path) -> None:
    alone = CliRunner().invoke(app, [str(csv_file)])
    assert "nothing here has checked mass and units" in alone.output
    assert alone.exit_code == 0
    compared = CliRunner().invoke(app, [str(csv_file), "--mass-kg", "200"])
    assert "note: nothing" not in compared.output
    assert "look like" not in compared.output


def test_semicolons_between_the_columns_are_named(csv_file: Path) -> None:
    csv_file.write_text(csv_file.read_text(encoding="utf-8").replace(",", ";"), encoding="utf-8")
    result = CliRunner().invoke(app, [str(csv_file)])
    assert isinstance(result.exception, PayloadFileInvalid)
    assert "separated by ';'" in str(result.exception)
