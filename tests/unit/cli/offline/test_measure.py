import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from cellctl.cli.offline.measure import measure
from cellctl.vision.picture import INSET_PX
from tests.unit.vision.plates import (
    Light,
    cut_head,
    holes_triangle,
    plate_facing,
    render_pair,
    write_stereo_head,
)

HEAD, POSE = cut_head(), plate_facing(3.0, -2.0, 2.0)
HOLES = holes_triangle(("pin", "pin", "countersink"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("measure")
    write_stereo_head(path / "head.json", HEAD)
    for name, image in zip(("left", "right"), render_pair(HEAD, POSE, HOLES, Light()), strict=True):
        cv2.imwrite(str(path / f"{name}.png"), image)
    text = ""
    for hole in HOLES:
        place = (hole.position_m * 1e3).tolist()
        text += f'[[hole]]\nname = "{hole.name}"\nkind = "{hole.kind}"\n'
        text += f"diameter_mm = {hole.diameter_m * 1e3}\nposition_mm = {place}\n"
        text += "countersink_mm = 10.0\n" if hole.countersink_m else ""
    (path / "plate.toml").write_text(text)
    return path


def run(folder: Path, *more: str, features: str = "plate.toml", right: str = "right.png") -> Any:
    app = typer.Typer()
    app.command()(measure)
    arguments = ["--calibration", str(folder / "head.json"), "--features", str(folder / features)]
    arguments += ["--left", str(folder / "left.png"), "--right", str(folder / right), *more]
    return CliRunner().invoke(app, arguments)


def test_the_result_is_json_in_mm(folder: Path) -> None:
    picture = folder / "picture.png"
    result = run(folder, "--out", str(folder / "out.json"), "--picture", str(picture))
    assert result.exit_code == 0, result.output
    data = json.loads((folder / "out.json").read_text())
    truth = POSE.apply(np.array([hole.position_m for hole in HOLES])) * 1e3
    measured = np.array([data["holes"][hole.name]["position_mm"] for hole in HOLES])
    assert np.abs(measured - truth).max() < 0.015
    pose = np.array(data["camera_T_part"])
    assert np.abs(pose[:3, 3] - POSE.translation * 1e3).max() < 0.02
    assert np.array(data["covariance"]).shape == (6, 6)
    assert np.array(data["holes"]["P1"]["left_covariance_px2"]).shape == (2, 2)
    drawn = cv2.imread(str(picture))
    assert drawn is not None
    width, height = HEAD.image_size
    assert drawn.shape == (height + INSET_PX, 2 * width, 3)


def test_the_paper_by_name_on_stdout(folder: Path) -> None:
    result = run(folder, "--method", "paper")
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["method"] == "paper"


def test_missing_holes_exit_with_3_and_say_which(folder: Path) -> None:
    text = (folder / "plate.toml").read_text()
    text += '[[hole]]\nname = "P7"\nkind = "pin"\ndiameter_mm = 6.0\nposition_mm = [30, 30, 0]\n'
    (folder / "more.toml").write_text(text)
    result = run(folder, features="more.toml")
    assert result.exit_code == 3
    assert "F421" in result.stderr
    assert "P7" in result.stderr
    assert result.stdout == ""


def test_files_that_are_not_images_exit_with_1(folder: Path) -> None:
    for right in ("plate.toml", "none.png"):
        result = run(folder, right=right)
        assert result.exit_code == 1
        assert "F403" in result.stderr


@pytest.mark.parametrize("kind", [np.uint16, np.float32])
def test_images_of_other_depths_are_refused_by_a_text_that_says_so(
    folder: Path, kind: type[np.generic]
) -> None:
    image = cv2.imread(str(folder / "right.png"), cv2.IMREAD_UNCHANGED)
    assert image is not None
    name = f"deep-{kind.__name__}.tiff"
    cv2.imwrite(str(folder / name), image.astype(kind))
    result = run(folder, right=name)
    assert result.exit_code == 1
    assert f"{name}: needs 8 bit grey values, has {kind.__name__}" in result.stderr


def test_a_head_that_did_not_pass_is_measured_with_a_warning(folder: Path) -> None:
    data = json.loads((folder / "head.json").read_text())
    (folder / "failed.json").write_text(json.dumps({**data, "verdict": "fail"}))
    result = run(folder, "--calibration", str(folder / "failed.json"))
    assert result.exit_code == 0
    assert "warning" in result.stderr
    assert "did not pass its checks" in result.stderr
    assert "did not pass" not in run(folder).stderr


def test_the_command_loads_nothing_that_it_does_not_need() -> None:
    """It must start in little more than a second, and libraries of plots and stores take longer."""
    code = "import cellctl.cli.offline.measure, sys; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=600
    ).stdout.split()
    assert "cellctl.vision.measure" in loaded
    heavy = {"matplotlib", "sqlalchemy", "pydantic_settings", "fastapi", "mcap", "harvesters"}
    assert heavy.isdisjoint(loaded)


def test_exchanged_images_are_named(folder: Path) -> None:
    app = typer.Typer()
    app.command()(measure)
    arguments = ["--calibration", str(folder / "head.json"), "--features"]
    arguments += [str(folder / "plate.toml"), "--left", str(folder / "right.png")]
    result = CliRunner().invoke(app, [*arguments, "--right", str(folder / "left.png")])
    assert result.exit_code == 1
    assert "left and right are exchanged" in result.output


@pytest.mark.parametrize(
    ("size", "words"), [(0.5, "found twice as wide as drawn"), (2.0, "found half as wide")]
)
def test_radii_in_place_of_diameters_are_named(folder: Path, size: float, words: str) -> None:
    text = (folder / "plate.toml").read_text()
    sizes = r"((?:diameter|countersink)_mm) = ([\d.]+)"
    other = re.sub(sizes, lambda found: f"{found[1]} = {size * float(found[2])}", text)
    assert other != text
    (folder / "radii.toml").write_text(other)
    app = typer.Typer()
    app.command()(measure)
    arguments = ["--calibration", str(folder / "head.json"), "--features"]
    arguments += [str(folder / "radii.toml"), "--left", str(folder / "left.png")]
    result = CliRunner().invoke(app, [*arguments, "--right", str(folder / "right.png")])
    assert result.exit_code == 1
    assert words in result.output


def test_one_image_for_both_cameras_is_named(folder: Path) -> None:
    result = run(folder, right="left.png")
    assert result.exit_code == 1
    assert "the same image" in result.output


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(
    "outward", ["", pytest.param("outward_axis = [0.0, 0.0, 1.0]\n", marks=pytest.mark.figures)]
)
def test_a_mirrored_drawing_is_named(folder: Path, sign: float, outward: str) -> None:
    """Holes in a plane fit their mirror image as seen from the back, with the same residuals."""

    def changed(found: re.Match[str]) -> str:
        return f"position_mm = [{sign * float(found[1])},"

    text = re.sub(r"position_mm = \[(-?[\d.]+),", changed, (folder / "plate.toml").read_text())
    (folder / "other.toml").write_text(outward + text)
    result = run(folder, features="other.toml")
    if sign > 0:
        assert result.exit_code == 0, result.output
        return
    assert result.exit_code == 1
    assert "F424 The drawing is mirrored" in result.stderr
    assert "x" in result.stderr
    assert result.stdout == ""


def test_z_into_the_part_has_to_be_stated(folder: Path) -> None:
    text = (folder / "plate.toml").read_text()
    for y in (-16.7, 83.3, -66.7):
        assert f", {y}, 0.0]" in text
        text = text.replace(f", {y}, 0.0]", f", {-y}, 0.0]")
    (folder / "down.toml").write_text(text)
    assert "outward_axis = [0.0, 0.0, -1.0]" in run(folder, features="down.toml").stderr
    (folder / "down.toml").write_text("outward_axis = [0.0, 0.0, -1.0]\n" + text)
    assert run(folder, features="down.toml").exit_code == 0


@pytest.mark.figures  # as z into the part is
def test_an_outward_axis_into_the_part_is_named(folder: Path) -> None:
    text = (folder / "plate.toml").read_text()
    (folder / "inward.toml").write_text("outward_axis = [0.0, 0.0, -1.0]\n" + text)
    result = run(folder, features="inward.toml")
    assert "F424" in result.stderr
    assert "correct `outward_axis`" in result.stderr
