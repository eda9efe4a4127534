"""A real arm that job programs stop needs a contact of the PC in its permit loop."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.config import load_cell, problems, problems_before_commissioning

CONFIG = Path(__file__).parents[4] / "config"
PERMIT = 'permit = { device = "permit", output = "%s_permit" }\n'


def filled_in(folder: Path, *without: str) -> Path:
    """The template of a real cell, its marks taken away, some arms without their contact."""
    text = (CONFIG / "cell.toml").read_text().replace("FILL IN", "found")
    for arm in without:
        assert PERMIT % arm in text
        text = text.replace(PERMIT % arm, "")
    (folder / "features").symlink_to(CONFIG / "features")
    path = folder / "cell.toml"
    path.write_text(text)
    return path


def test_the_template_has_a_contact_for_every_arm(tmp_path: Path) -> None:
    path = filled_in(tmp_path)
    assert problems_before_commissioning(path) == []
    assert {robot.permit is not None for robot in load_cell(path).robots.values()} == {True}


@pytest.mark.parametrize("arm", ["main", "aux_1"])
def test_check_demands_it(tmp_path: Path, arm: str) -> None:
    path = filled_in(tmp_path, arm)
    lines = path.read_text().splitlines()
    found = problems_before_commissioning(path)
    assert [(one.key, one.line) for one in found] == [
        (f"robots.{arm}.permit", lines.index(f"[robots.{arm}]") + 1)
    ]
    done = CliRunner().invoke(whole_app(), ["check", str(path)])
    assert done.exit_code == 1
    assert "permit loop" in done.output


def test_a_cell_that_has_worked_without_it_still_starts(tmp_path: Path) -> None:
    path = filled_in(tmp_path, "main", "aux_1", "aux_2")
    assert problems(path) == []
    assert set(load_cell(path).robots) == {"main", "aux_1", "aux_2"}


@pytest.mark.parametrize(
    ("name", "demanded"), [("antenna.toml", True), ("antenna-rpc.toml", False)]
)
def test_neither_simulated_arms_nor_those_without_jobs_need_it(
    tmp_path: Path, name: str, demanded: bool
) -> None:
    assert problems_before_commissioning(CONFIG / name) == []
    for folder in CONFIG.iterdir():
        if folder.is_dir():
            (tmp_path / folder.name).symlink_to(folder)
    real = tmp_path / name
    real.write_text((CONFIG / name).read_text().replace("simulated = true\n", ""))
    keys = [one.key for one in problems_before_commissioning(real)]
    assert any(key.endswith(".permit") for key in keys) is demanded


def test_an_arm_with_wrong_settings_is_reported_once(tmp_path: Path) -> None:
    path = filled_in(tmp_path, "main")
    path.write_text(path.read_text().replace('robot_name = "SR500A"', "", 1))
    keys = [one.key for one in problems_before_commissioning(path)]
    assert [key for key in keys if key.startswith("robots.")] == ["robots.main.settings.robot_name"]


@pytest.mark.parametrize(
    ("old", "new", "key", "said"),
    [
        ('output = "aux_1_permit"', 'output = "aux_1_permits"', "output", "aux_1_permit"),
        ('output = "aux_1_permit"', 'output = "main_permit"', "output", "one contact"),
        ('output = "aux_1_permit"', 'output = "loop"', "output", "loop is an input; an output of"),
        (
            '{ device = "permit", output = "aux_1_permit" }',
            '{ device = "permits", output = "aux_1_permit" }',
            "device",
            "digital_ios: permit",
        ),
    ],
)
def test_the_contact_must_be_an_output_of_its_device_and_no_other_arms(
    tmp_path: Path, old: str, new: str, key: str, said: str
) -> None:
    path = filled_in(tmp_path)
    text = path.read_text().replace(
        "outputs = { main_permit", "inputs = { loop = 0 }, outputs = { main_permit"
    )
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))
    found = [one for one in problems(path) if one.key == f"robots.aux_1.permit.{key}"]
    assert len(found) == 1
    assert said in found[0].allowed


def test_an_output_of_a_device_with_wrong_settings_is_not_judged(tmp_path: Path) -> None:
    path = filled_in(tmp_path)
    text = path.read_text()
    path.write_text(text.replace("outputs = { main_permit", "output = { main_permit"))
    assert all(one.key.startswith("digital_ios.permit") for one in problems(path))
    assert problems(path) != []
