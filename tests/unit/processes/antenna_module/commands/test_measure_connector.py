"""``cellctl measure-connector`` as a user runs it."""

import json
import tomllib
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import typer
from typer.testing import CliRunner, Result

from cellctl.cli.root import new_app
from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.commands.measure_connector import add
from tests.rigs.antenna.small_pictures import CONNECTOR, picture
from tests.rigs.sweeps import sweep


def run(folder: Path, *words: str) -> Result:
    app: typer.Typer = new_app()
    add(app)
    arguments = ["measure-connector", "--camera", str(folder / "cam.json")]
    arguments += ["--plane", str(folder / "plane.json"), "--image", str(folder / "a.png")]
    if "--connector" not in words:
        arguments += ["--connector", str(CONNECTOR)]
    return CliRunner().invoke(app, [*arguments, "--out", str(folder / "plug.json"), *words])


def result(folder: Path) -> dict[str, Any]:
    data: dict[str, Any] = json.loads((folder / "plug.json").read_text())
    return data


def states(folder: Path) -> dict[str, str]:
    return {contact["name"]: contact["state"] for contact in result(folder)["contacts"]}


@pytest.mark.parametrize(
    ("method", "limit_mm"), sweep((("default", 0.0015), ("paper", 0.003)), (("default", 0.0015),))
)
def test_a_good_plug_is_measured(tmp_path: Path, method: str, limit_mm: float) -> None:
    seen = picture()
    seen.write(tmp_path)
    done = run(tmp_path, "--method", method, "--picture", str(tmp_path / "p.png"))
    assert done.exit_code == 0, done.output
    data = result(tmp_path)
    assert data["method"] == method
    pose = np.array(data["camera_T_connector"])
    truth = seen.camera_T_connector
    assert np.abs(pose[:3, 3] - truth.translation / MM).max() < limit_mm
    assert np.abs(pose[:3, :3] - truth.rotation.as_matrix()).max() < 1e-3
    assert set(states(tmp_path).values()) == {"ok"}
    assert data["camera_id"] == seen.camera.id
    assert data["free"] == ["x", "y", "rz"]
    sigma = np.sqrt(np.diag(data["covariance"]))
    # Height and tilts are those that the plane file has by default.
    assert sigma[2] == pytest.approx(0.2, rel=0.01)
    assert sigma[3:5] == pytest.approx(np.radians(0.1), rel=0.01)
    assert sigma[:2].max() < 0.003
    drawn = cv2.imread(str(tmp_path / "p.png"))
    assert drawn is not None
    assert drawn.shape[0] > 200


def test_a_refusal_is_as_wide_as_the_terminal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "80")
    picture(missing=("6",)).write(tmp_path)
    done = run(tmp_path)
    assert "F472 A contact is missing: 6 missing" in done.stderr
    assert max(len(line) for line in done.stderr.splitlines()) <= 80


def test_a_missing_contact_is_named_and_the_result_written(tmp_path: Path) -> None:
    seen = picture(missing=("6",))
    seen.write(tmp_path)
    done = run(tmp_path)
    assert done.exit_code == 3
    assert "F472 A contact is missing: 6 missing" in done.stderr
    assert [name for name, state in states(tmp_path).items() if state != "ok"] == ["6"]
    pose = np.array(result(tmp_path)["camera_T_connector"])
    assert np.abs(pose[:3, 3] - seen.camera_T_connector.translation / MM).max() < 0.002
    assert run(tmp_path, "--tolerate", "1").exit_code == 0


def test_the_paper_refuses_a_missing_contact(tmp_path: Path) -> None:
    picture(missing=("6",)).write(tmp_path)
    done = run(tmp_path, "--method", "paper")
    assert done.exit_code == 3
    assert "F477" in done.stderr
    assert "14 circles, 15 contacts" in done.stderr


def test_a_bent_contact_is_named_with_its_place(tmp_path: Path) -> None:
    picture(bent="11").write(tmp_path)
    done = run(tmp_path)
    assert done.exit_code == 3
    assert "F473 A contact is bent: 11 bent by +0.1" in done.stderr


def test_a_turned_plug_is_refused(tmp_path: Path) -> None:
    picture(turn_deg=180.0).write(tmp_path)
    done = run(tmp_path)
    assert done.exit_code == 1
    assert "F469 Connector is turned by 180°" in done.stderr


def test_the_file_of_another_connector_is_refused(tmp_path: Path) -> None:
    picture().write(tmp_path)
    done = run(tmp_path, "--connector", "config/connectors/d-sub-15-pins.toml")
    assert done.exit_code == 1
    assert "F468 Contacts do not fit the connector file" in done.stderr


def drawn(folder: Path, sign: float, *, without: str = "") -> Path:
    """The drawing with x times ``sign``, and without one of its contacts."""
    data = tomllib.loads(CONNECTOR.read_text())
    lines = [f"{key} = {json.dumps(one)}" for key, one in data.items() if key != "contact"]
    for contact in data["contact"]:
        if contact["name"] != without:
            x, y = contact["position_mm"]
            lines += ["[[contact]]", f'name = "{contact["name"]}"']
            lines += [f"position_mm = [{sign * x}, {y}]"]
    path = folder / "drawn.toml"
    path.write_text("\n".join(lines))
    return path


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_mirrored_drawing_of_a_keyed_plug_is_named(tmp_path: Path, sign: float) -> None:
    """Without contact 3 the plug differs from its mirror image, in which it has no contact 6."""
    picture(missing=("3",)).write(tmp_path)
    done = run(tmp_path, "--connector", str(drawn(tmp_path, sign, without="3")))
    if sign > 0:
        assert done.exit_code == 0, done.output
        assert "mirror" not in done.stderr
    else:
        assert done.exit_code == 1
        assert "F470 Image or drawing is mirrored: 14 of 14 features" in done.stderr


def test_a_mirrored_drawing_that_no_picture_shows_is_told_of(tmp_path: Path) -> None:
    picture().write(tmp_path)
    done = run(tmp_path, "--connector", str(drawn(tmp_path, -1.0)))
    assert done.exit_code == 0
    assert "the contacts look the same in a mirror" in done.stderr
    assert any("look the same in a mirror" in words for words in result(tmp_path)["warnings"])


def test_exchanged_intrinsics_are_refused(tmp_path: Path) -> None:
    picture().write(tmp_path)
    plane = json.loads((tmp_path / "plane.json").read_text())
    (tmp_path / "plane.json").write_text(json.dumps(plane | {"camera_id": "0" * 64}))
    done = run(tmp_path)
    assert done.exit_code == 1
    assert "F464 Plane and camera calibration do not belong together" in done.stderr


def test_a_plane_in_metres_is_named(tmp_path: Path) -> None:
    picture().write(tmp_path)
    plane = json.loads((tmp_path / "plane.json").read_text())
    pose = plane["camera_T_plane"]
    in_metres = (
        [[*row[:3], row[3] / 1e3] for row in pose[:3]] + pose[3:]
        if len(pose) == 4
        else [value / 1e3 for value in pose[:3]] + pose[3:]
    )
    (tmp_path / "plane.json").write_text(json.dumps(plane | {"camera_T_plane": in_metres}))
    done = run(tmp_path)
    assert done.exit_code == 1
    assert "camera_T_plane: millimetres belong here; these look like metres" in done.stderr


def test_changed_intrinsics_are_refused(tmp_path: Path) -> None:
    picture().write(tmp_path)
    camera = json.loads((tmp_path / "cam.json").read_text())
    camera["camera_matrix"][0][2] += 1.0
    (tmp_path / "cam.json").write_text(json.dumps(camera))
    done = run(tmp_path)
    assert done.exit_code == 1
    assert "id does not belong to these intrinsics" in done.stderr


def test_an_image_without_a_connector_is_refused(tmp_path: Path) -> None:
    seen = picture()
    seen.write(tmp_path)
    noise = np.random.default_rng(1).normal(90.0, 6.0, seen.image.shape[:2])
    noise += np.linspace(-40, 40, noise.shape[1])
    cv2.imwrite(str(tmp_path / "a.png"), np.clip(noise, 0, 255).astype(np.uint8))
    done = run(tmp_path)
    assert done.exit_code == 3
    assert "F466 Connector was not found" in done.stderr
