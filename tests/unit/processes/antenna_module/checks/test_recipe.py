"""What `cellctl check` finds wrong with a reference in the shipped cell file."""

from pathlib import Path

from cellctl.config.load import problems


def change(cell: Path, old: str, new: str) -> None:
    text = cell.read_text(encoding="utf-8")
    assert old in text
    cell.write_text(text.replace(old, new), encoding="utf-8")


def test_the_shipped_reference_can_be_used(cell: Path) -> None:
    assert problems(cell) == []


def test_the_pose_over_the_plate_is_missed(cell: Path) -> None:
    change(cell, "\nreference_look = ", "\nelsewhere = ")
    (issue,) = problems(cell)
    assert issue.key == "robots.arm.poses_deg"
    assert "reference_look" in str(issue)


def test_the_drawing_of_the_plate_is_missed(cell: Path) -> None:
    (cell.parent / "connectors" / "reference-plate-below.toml").unlink()
    (issue,) = problems(cell)
    assert issue.key == "processes.antenna-module.reference"
    assert "reference-plate-below" in str(issue)


def test_a_cell_without_a_plate_needs_neither(cell: Path) -> None:
    text = cell.read_text(encoding="utf-8")
    begin = text.index("[processes.antenna-module.reference]")
    end = text.index("[[recipes]]")
    cell.write_text(text[:begin] + text[end:], encoding="utf-8")
    change(cell, "\nreference_look = ", "\nelsewhere = ")
    assert problems(cell) == []
