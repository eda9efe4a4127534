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
