"""The cell file: every error at once, with key, value and what is allowed."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.config import load_cell, problems
from cellctl.config.commissioning import examine_before_commissioning
from cellctl.config.driver_settings import first_link_mm
from cellctl.errors.config import ConfigInvalid, ConfigUnreadable

CONFIG = Path(__file__).parents[3] / "config"


@pytest.mark.parametrize("name", ["deck.toml", "cell.toml", "deck-gige.toml", "antenna-gige.toml"])
def test_the_shipped_cell_files_are_good(name: str) -> None:
    assert problems(CONFIG / name) == []


def test_the_template_keeps_its_data_where_the_unit_lets_the_daemon_write() -> None:
    cell = load_cell(CONFIG / "cell.toml")
    unit = (CONFIG.parent / "systemd" / "cellctl.service").read_text()
    assert "StateDirectory=cellctl\n" in unit
    for folder in (cell.data_dir, cell.calibration_dir):
        assert Path("/var/lib/cellctl") in (Path(folder), *Path(folder).parents)


def changed(tmp_path: Path, **replacements: tuple[str, str]) -> Path:
    """The fake cell's file with some lines replaced, next to its feature files."""
    text = (CONFIG / "deck.toml").read_text()
    for old, new in replacements.values():
        assert old in text
        text = text.replace(old, new, 1)
    (tmp_path / "features").symlink_to(CONFIG / "features")
    path = tmp_path / "cell.toml"
    path.write_text(text)
    return path


def test_all_errors_are_reported_together(tmp_path: Path) -> None:
    path = changed(
        tmp_path,
        threshold=("threshold_mm = 0.05", "threshold_mm = -1.0"),
        thickness=("deck_thickness_mm = 15.0", "deck_thicknes_mm = 15.0"),
        port=("port = 5020", 'port = "many"'),
    )
    found = {problem.key: problem for problem in problems(path)}
    assert set(found) == {
        "plc.port",
        "recipes.0.pose_correction.threshold_mm",
        "recipes.0.deck_thickness_mm",
        "recipes.0.deck_thicknes_mm",
    }
    assert "more than 0" in found["recipes.0.pose_correction.threshold_mm"].allowed
    assert found["recipes.0.pose_correction.threshold_mm"].value == "-1.0"
    assert found["recipes.0.deck_thickness_mm"].value == "(missing)"


def test_errors_in_a_drivers_settings_carry_their_path(tmp_path: Path) -> None:
    path = changed(tmp_path, speed=("max_speed_mm_s = 100.0", "max_speed_mm_s = 1e9"))
    (problem,) = problems(path)
    assert problem.key == "robots.main.settings.max_speed_mm_s"
    with pytest.raises(ConfigInvalid, match="max_speed_mm_s"):
        load_cell(path)


def test_an_unknown_driver_lists_the_installed_ones(tmp_path: Path) -> None:
    path = changed(tmp_path, driver=('driver = "target-server"', 'driver = "laser"'))
    (problem,) = problems(path)
    assert (problem.key, problem.number) == ("trackers.tracker.driver", 103)
    assert "target-server" in problem.allowed


def test_real_and_simulated_devices_do_not_mix(tmp_path: Path) -> None:
    path = changed(tmp_path, mix=("simulated = true", "simulated = false"))
    (problem,) = problems(path)
    assert problem.number == 104


def test_a_missing_feature_file_is_an_error(tmp_path: Path) -> None:
    path = changed(tmp_path, feature=("features/deck.toml", "features/none.toml"))
    (problem,) = problems(path)
    assert problem.key == "recipes.0.deck_features"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("head_1 = ", "other = ", "unknown key"),
        ("head_1 = [", "head_1 = []\n# [", "head_1 must list"),
        ("head_2 = [", "head_2 = []\n# [", "head_2 must list"),
        ("position_mm", "position", "unknown key"),
        ("[[hole]]", "[[hole", "not TOML"),
    ],
)
def test_a_feature_file_that_no_part_can_be_measured_with_is_an_error(
    tmp_path: Path, old: str, new: str, said: str
) -> None:
    text = (CONFIG / "features" / "deck.toml").read_text()
    assert old in text
    (tmp_path / "broken.toml").write_text(text.replace(old, new, 1))
    path = changed(tmp_path, feature=("features/deck.toml", "broken.toml"))
    (problem,) = problems(path)
    assert (problem.key, problem.number) == ("recipes.0.deck_features", 402)
    assert said in problem.allowed


def test_heads_that_see_too_little_of_a_part_together_are_an_error(tmp_path: Path) -> None:
    text = (CONFIG / "features" / "frame.toml").read_text()
    for line in [line for line in text.splitlines() if line.startswith("head_")]:
        text = text.replace(line, f'{line.split("=")[0]}= ["P1"]')
    (tmp_path / "few.toml").write_text(text)
    (problem,) = problems(changed(tmp_path, feature=("features/frame.toml", "few.toml")))
    assert "three holes" in problem.allowed


@pytest.mark.parametrize("client", ["plc", "192.168.10", "192.168.10.2/99"])
def test_allowed_clients_are_addresses(tmp_path: Path, client: str) -> None:
    line = "heartbeat_timeout_s = 3.0"
    path = changed(tmp_path, client=(line, f'{line}\nallowed_clients = ["{client}"]'))
    (problem,) = problems(path)
    assert problem.key == "plc.allowed_clients"


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.10.1", "cell-pc"])
def test_a_port_that_others_reach_names_its_clients(tmp_path: Path, host: str) -> None:
    line = 'host = "127.0.0.1"\nport = 5020'
    (problem,) = problems(changed(tmp_path, h=(line, f'host = "{host}"\nport = 5020')))
    assert problem.key == "plc.host"
    assert "whoever may connect may start the cell" in problem.allowed
    assert "0.0.0.0/0" not in problem.allowed


def test_a_port_may_be_open_to_everybody_where_that_is_said(tmp_path: Path) -> None:
    line = 'host = "127.0.0.1"\nport = 5020'
    opened = 'host = "0.0.0.0"\nport = 5020\nallowed_clients = ["0.0.0.0/0"]'
    assert not problems(changed(tmp_path, h=(line, opened)))


@pytest.mark.parametrize("client", ["192.168.10.2", "192.168.10.0/24", "fd00::1"])
def test_addresses_and_networks_may_be_allowed(tmp_path: Path, client: str) -> None:
    line = "heartbeat_timeout_s = 3.0"
    assert not problems(changed(tmp_path, c=(line, f'{line}\nallowed_clients = ["{client}"]')))


def test_check_tells_of_a_recipe_that_no_mating_can_be_planned_for(tmp_path: Path) -> None:
    path = changed(tmp_path, force=("target_force_n = 35.0", "target_force_n = 44.0"))
    result = CliRunner().invoke(whole_app(), ["check", str(path)])
    assert result.exit_code == 1
    assert re.search(r"F528 line \d+: recipes\.0\.mating", result.output)
    assert "no window for the final force" in result.output


@pytest.mark.parametrize("content", [b"= broken", b"\xff\xfe", None])
def test_an_unreadable_file_says_where(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "cell.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ConfigUnreadable, match=r"cell\.toml"):
        problems(path)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("features/deck.toml", "the drawing of a part"),
        ("connectors/micro-d-15-pins.toml", "the drawing of a connector"),
        ("connectors/gripper.toml", "the drawing of marks"),
        ("deck.model.toml", "the model of a cell"),
        ("deck.scenario.toml", "the scenario of a fake cell"),
        ("antenna.scenario.toml", "the scenario of a fake cell"),
        ("insertion-pin.model.toml", "the model of a cell"),
        ("insertion-connector.model.toml", "the model of a cell"),
    ],
)
def test_another_file_of_the_cell_is_named_as_what_it_is(name: str, said: str) -> None:
    with pytest.raises(ConfigUnreadable, match=said):
        problems(CONFIG / name)


def test_recipe_numbers_must_differ(tmp_path: Path) -> None:
    text = (CONFIG / "deck.toml").read_text()
    once = text[text.index("[[recipes]]") :]
    path = changed(tmp_path, twice=("[[recipes]]", f"{once}\n[[recipes]]"))
    (problem,) = problems(path)
    assert "recipe ids must differ" in problem.allowed


def test_check_exits_with_one_and_names_the_key(tmp_path: Path) -> None:
    path = changed(tmp_path, threshold=("threshold_mm = 0.05", "threshold_mm = 7"))
    result = CliRunner().invoke(whole_app(), ["check", str(path)])
    assert result.exit_code == 1
    assert "recipes.0.pose_correction" in result.output
    assert CliRunner().invoke(whole_app(), ["check", str(CONFIG / "deck.toml")]).exit_code == 0


def test_check_tells_of_calibrations_that_this_user_may_not_write(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = changed(tmp_path, folder=("demo-calibration", "calibration"))
    assert "may not write" not in CliRunner().invoke(whole_app(), ["check", str(path)]).output
    monkeypatch.setattr("cellctl.cli.commissioning.hints.may_write", lambda _: False)
    result = CliRunner().invoke(whole_app(), ["check", str(path)])
    assert result.exit_code == 0
    assert "may not write" in result.output
    assert not (tmp_path / "calibration").exists()


def test_a_recipe_says_what_the_cell_lacks(tmp_path: Path) -> None:
    path = changed(
        tmp_path,
        head=("[stereo_cameras.head_2]", "[stereo_cameras.second]"),
        pose=("retracted = ", "away = "),
    )
    found = {problem.key: problem.allowed for problem in problems(path)}
    assert set(found) == {"recipes.0.roles.head_2", "robots.aux_1.poses_deg.retracted"}
    assert "the cell lacks [stereo_cameras.head_2]" in found["recipes.0.roles.head_2"]


def test_a_role_may_be_taken_by_a_device_of_another_name(tmp_path: Path) -> None:
    path = changed(
        tmp_path,
        head=("[stereo_cameras.head_2]", "[stereo_cameras.second]"),
        roles=("id = 1\n", 'id = 1\nroles = { head_2 = "second" }\n'),
    )
    assert problems(path) == []


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ('carried_by = "aux_2"', 'carried_by = "aux_3"', "stereo_cameras.head_2.carried_by"),
        ('carried_by = "aux_2"\n', "", "stereo_cameras.head_2.carried_by"),
        ('mounted_on = "main"', 'mounted_on = "aux_1"', "force_sensors.force.mounted_on"),
        ('mounted_on = "main"', 'mounted_on = "arm"', "force_sensors.force.mounted_on"),
        ('process = "deck-to-frame"', 'process = "welding"', "recipes.0.process"),
        ('process = "deck-to-frame"\n', "", "recipes.0.process"),
        ("id = 1\n", 'id = 1\nroles = { head_3 = "head_1" }\n', "recipes.0.roles.head_3"),
        ("[trackers.tracker]", "[trackers.head_1]", "trackers.head_1"),
        ('board = "9x6"', "board = 9", "processes.deck-to-frame.board"),
        ("[processes.deck-to-frame]", "[processes.deck]", "processes.deck"),
    ],
)
def test_devices_and_processes_belong_together(
    tmp_path: Path, old: str, new: str, key: str
) -> None:
    assert key in {problem.key for problem in problems(changed(tmp_path, one=(old, new)))}


def test_a_misspelt_table_of_a_process_is_one_mistake(tmp_path: Path) -> None:
    path = changed(tmp_path, a=("[processes.deck-to-frame]", "[processes.deck_to_frame]"))
    (issue,) = examine_before_commissioning(path).errors
    assert issue.key == "processes.deck_to_frame"
    assert "did you mean 'deck-to-frame'?" in issue.allowed


def test_a_missing_table_of_a_process_is_one_mistake_that_names_its_keys(tmp_path: Path) -> None:
    path = changed(tmp_path, a=("[processes.deck-to-frame]", "[robots.main.other]"))
    (issue,) = [one for one in problems(path) if one.key.startswith("processes")]
    assert issue.key == "processes.deck-to-frame"
    assert "base_frame_joints_deg, flange_T_target_board" in issue.allowed


def test_check_says_which_recipes_the_cell_can_run() -> None:
    result = CliRunner().invoke(whole_app(), ["check", str(CONFIG / "deck.toml")])
    assert "(deck-to-frame): this cell can run it" in result.output


def test_a_sensor_with_bad_settings_is_reported_and_judged_no_further(tmp_path: Path) -> None:
    path = changed(tmp_path, one=('transport = "tcp"', 'transport = "telepathy"'))
    assert {problem.key for problem in problems(path)} == {"force_sensors.force.settings.transport"}


def test_check_says_whose_joint_moves_nobody_checks(tmp_path: Path) -> None:
    words = "robots.main: joint moves are not checked"
    filled_in = tmp_path / "cell.toml"
    filled_in.write_text((CONFIG / "cell.toml").read_text().replace("FILL IN", "found"))
    (tmp_path / "features").symlink_to(CONFIG / "features")
    assert words in CliRunner().invoke(whole_app(), ["check", str(filled_in)]).output
    assert words not in CliRunner().invoke(whole_app(), ["check", str(CONFIG / "deck.toml")]).output


def test_the_first_link_is_taken_from_the_dh_table_where_it_is_not_stated(tmp_path: Path) -> None:
    lengths = ("d1_mm = 1045.0\na1_mm = 500.0\n", "")
    path = changed(tmp_path, stated=lengths)
    assert problems(path) == []
    assert first_link_mm(load_cell(path).robots["main"]) == pytest.approx((1045.0, 500.0))
    path.write_text(re.sub(r"^dh = .*\n", "", path.read_text(), count=1, flags=re.MULTILINE))
    missing = {problem.key for problem in problems(path)}
    assert {"robots.main.d1_mm", "robots.main.a1_mm"} <= missing


def test_a_misspelt_device_is_named_with_the_one_that_was_meant(tmp_path: Path) -> None:
    text = (Path(__file__).parents[3] / "config" / "deck.toml").read_text()
    path = tmp_path / "cell.toml"
    path.write_text(text.replace("[robots.aux_1.poses_deg]", "[robots.aux1.poses_deg]"))
    (issue,) = problems(path)
    assert issue.key == "robots.aux1.driver"
    assert issue.line == text[: text.index("[robots.aux_1.poses_deg]")].count("\n") + 1
    assert "did you mean 'aux_1'? the name of a driver" in issue.allowed
