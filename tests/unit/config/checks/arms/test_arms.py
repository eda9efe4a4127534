"""What `cellctl check` says of tables, boxes and joint limits, in cell files that were changed."""

from pathlib import Path

import pytest

from cellctl.config.checks.arms.boxes import box_remarks
from cellctl.config.checks.arms.needs import arm_needs, rooms
from cellctl.config.checks.arms.tables import table_remarks
from cellctl.config.commissioning import examine_before_commissioning
from tests.unit.config.test_mistakes import written

DECK, PIN = "deck.toml", "insertion-pin.toml"


def said_of(folder: Path, name: str, old: str, new: str) -> list[str]:
    """Remarks on a file that stays good."""
    examined = examine_before_commissioning(written(folder / "cell", name, old, new))
    assert [str(error) for error in examined.errors] == []
    return [str(remark) for remark in examined.remarks]


def refused(folder: Path, name: str, old: str, new: str) -> list[str]:
    """Errors of a file."""
    examined = examine_before_commissioning(written(folder / "cell", name, old, new))
    return [str(error) for error in examined.errors]


@pytest.mark.parametrize("name", [DECK, PIN, "insertion-connector.toml", "antenna.toml"])
def test_shipped_cells_have_no_remark_on_their_arms(tmp_path: Path, name: str) -> None:
    cell = examine_before_commissioning(written(tmp_path / "cell", name)).cell
    assert cell is not None
    assert [*table_remarks(cell), *box_remarks(cell, arm_needs(cell, tmp_path / "cell"))] == []


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("340.0]", "34.0]", "towards -z it leaves 352 mm beyond every taught pose and stated move"),
        ("340.0]", "-340.0]", "below the plane on which the arm stands"),
        ("= [250.0, -350.0,", "= [25.0, -350.0,", "within 25 mm of the axis A1"),
        ("= [250.0, -350.0,", "= [-250.0, -350.0,", "within 0 mm of the axis A1"),
        ("[700.0, 450.0, 750.0]", "[700.0, 1200.0, 750.0]", "bounds nothing towards +y"),
        ("150.0, 60.0, 110.0, 30.0]", "150.0, 60.0, 110.0, 300.0]", "A6 may go 480 deg beyond"),
        ("60.0, -60.0, 5.0, -350.0]", "-60.0, -60.0, 5.0, -350.0]", "A3 may go 174 deg beyond"),
        ("[0.0, 420.0, 0.0, 90.0]", "[0.0, 420.0, 5.0, 90.0]", "meet in one point"),
        ("[0.0, 0.0, 440.0, 0.0]", "[0.0, 10.0, 440.0, 0.0]", "beside its axis A1"),
    ],
)
def test_what_is_remarked_on(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert any(said in one for one in said_of(tmp_path, PIN, old, new))


def test_a_box_is_held_against_the_reach_and_not_against_shipped_figures(tmp_path: Path) -> None:
    everything = "workspace_min_mm = [-1200.0, -1200.0, -1200.0]"
    path = written(tmp_path / "cell", PIN, "workspace_min_mm = [250.0, -350.0, 340.0]", everything)
    wide = path.read_text().replace("[700.0, 450.0, 750.0]", "[1200.0, 1200.0, 1377.0]")
    path.write_text(wide)
    errors = [str(error) for error in examine_before_commissioning(path).errors]
    assert len(errors) == 1
    assert "the arm reaches none of its faces" in errors[0]


def test_a_box_that_holds_the_base_of_another_arm_is_refused(tmp_path: Path) -> None:
    # The arm of head 1 stands 2300 mm beside the main one, 1900 mm before it.
    wider = "joint_workspace_min_mm = [900.0, -2400.0, 350.0]"
    old = "joint_workspace_min_mm = [900.0, -1300.0, 350.0]"
    errors = refused(tmp_path, DECK, old, wider)
    assert len(errors) == 1
    assert "robots.main.settings.joint_workspace" in errors[0]
    assert "a box beside robots.aux_1" in errors[0]


def test_axes_that_are_askew_are_refused(tmp_path: Path) -> None:
    errors = refused(tmp_path, PIN, "[0.0, 0.0, 0.0, -90.0], [180", "[0.0, 0.0, 0.0, -80.0], [180")
    assert len(errors) == 1
    assert "alpha of A5: -80 deg: a multiple of 90 deg" in errors[0]


def test_two_arms_whose_tables_differ_in_one_figure_contradict_each_other(tmp_path: Path) -> None:
    errors = refused(tmp_path, DECK, "[0.0, 0.0, 1150.0, 0.0]", "[0.0, 0.0, 1140.0, 0.0]")
    assert len(errors) == 1
    assert "robots.aux_2.settings.dh = a of A2: 1150 mm" in errors[0]
    assert "robots.aux_1.settings.dh = a of A2: 1140 mm" in errors[0]


def test_one_angle_written_twice_is_no_difference(tmp_path: Path) -> None:
    remarks = said_of(tmp_path, DECK, "[180.0, 240.0, 0.0, 0.0]", "[-180.0, 240.0, 0.0, 0.0]")
    assert not any("settings.dh" in one for one in remarks)


def test_a_longer_flange_is_remarked_on_for_it_may_have_an_adapter(tmp_path: Path) -> None:
    remarks = said_of(tmp_path, DECK, "[180.0, 240.0, 0.0, 0.0]", "[180.0, 245.0, 0.0, 0.0]")
    assert any("right if this flange has an adapter" in one for one in remarks)


def test_a_table_is_held_against_the_published_reach_of_the_model(tmp_path: Path) -> None:
    path = written(tmp_path / "cell", DECK)
    path.write_text(path.read_text().replace('"SR500A"', '"SR210A"'))
    remarks = [str(one) for one in examine_before_commissioning(path).remarks]
    assert any("would reach 2826 mm, and arms of this model 2650 mm" in one for one in remarks)


def test_room_is_measured_to_the_outermost_places(tmp_path: Path) -> None:
    cell = examine_before_commissioning(written(tmp_path / "cell", PIN)).cell
    assert cell is not None
    (needs,) = arm_needs(cell, tmp_path / "cell")
    (room,) = rooms(cell.robots["arm"], needs)
    # The lowest place is the seat: face of the hole at 200, tool of 200, 12 mm deep, 1.5 uncertain.
    assert room.below_mm[2] == pytest.approx(200.0 + 200.0 - 12.0 - 1.5 - 340.0, abs=0.01)
    assert room.key == "robots.arm.settings.workspace"


def test_a_tilted_sensor_is_remarked_on(tmp_path: Path) -> None:
    old = "flange_T_sensor = [0.0, 0.0, 30.0, 0.0, 0.0, 0.0]"
    remarks = said_of(tmp_path, PIN, old, old.replace("0.0, 0.0]", "0.0, 10.0]"))
    assert any("tilted by 10 deg against the flange" in one for one in remarks)
