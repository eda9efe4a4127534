"""A contradiction names all values that take part, each with what it would have to be."""

import re
from pathlib import Path

import pytest

from cellctl.config import problems_before_commissioning
from cellctl.config.issue import ConfigIssue, WrittenValue
from tests.unit.config.test_mistakes import written

_PIN, _CONNECTOR, _DECK = "insertion-pin.toml", "insertion-connector.toml", "deck.toml"

CONTRADICTIONS = [
    (_DECK, "stand_off_mm = 10.0", "stand_off_mm = 100.0", "recipes.0.stand_off_mm"),
    (_PIN, "clearance_mm = 0.05", "clearance_mm = 0.5", "recipes.0.fit.clearance_mm"),
    (_PIN, "hole_chamfer_mm = 0.5", "hole_chamfer_mm = 5.0", "recipes.0.fit.hole_chamfer_mm"),
    (_PIN, "depth_mm = 12.0", "depth_mm = 120.0", "recipes.0.fit.depth_mm"),
    (_PIN, "force_sigma_n = 0.1", "force_sigma_n = 0.5", "processes.peg-in-hole.force_sigma_n"),
    (_PIN, "force_sigma_n = 0.1", "force_sigma_n = 10.0", "processes.peg-in-hole.force_sigma_n"),
    (
        _CONNECTOR,
        "withdrawal_n = 50.0",
        "withdrawal_n = 10.0",
        "recipes.0.forces.withdrawal_n",
    ),
]


def _values(issue: ConfigIssue) -> list[WrittenValue]:
    return [WrittenValue(issue.key, issue.value, issue.line, issue.allowed), *issue.against]


@pytest.mark.parametrize(("name", "old", "new", "wrong"), CONTRADICTIONS)
def test_the_wrong_key_is_named_with_its_line_in_every_message(
    tmp_path: Path, name: str, old: str, new: str, wrong: str
) -> None:
    path = written(tmp_path, name, old, new)
    line = path.read_text().split(new, 1)[0].count("\n") + 1
    found = problems_before_commissioning(path)
    assert found
    for issue in found:
        assert [one.line for one in _values(issue) if one.key == wrong] == [line], issue
        assert all(one.line is not None for one in _values(issue)), issue


@pytest.mark.parametrize(("name", "old", "new", "wrong"), CONTRADICTIONS)
def test_who_obeys_any_part_of_a_message_is_rid_of_it(
    tmp_path: Path, name: str, old: str, new: str, wrong: str
) -> None:
    path = written(tmp_path, name, old, new)
    text = path.read_text()
    obeyed = set()
    before = problems_before_commissioning(path)
    for issue in before:
        for value in _values(issue):
            limit = re.match(r"at (?:least|most) ([\d.]+)", value.allowed)
            if limit is None or value.line is None:
                continue
            lines = text.splitlines()
            last = value.key.rsplit(".", 1)[-1]
            lines[value.line - 1] = re.sub(
                rf"\b{last} = [\d.]+", f"{last} = {limit[1]}", lines[value.line - 1]
            )
            path.write_text("\n".join(lines))
            after = problems_before_commissioning(path)
            assert issue.allowed not in {one.allowed for one in after}, value
            assert len(after) <= len(before)
            obeyed.add(value.key)
    assert wrong in obeyed


@pytest.mark.parametrize(("name", "old", "new", "wrong"), CONTRADICTIONS[:-1])
def test_the_first_way_out_is_never_the_less_safe_one(
    tmp_path: Path, name: str, old: str, new: str, wrong: str
) -> None:
    found = problems_before_commissioning(written(tmp_path, name, old, new))
    for issue in found:
        assert "less safe" not in issue.allowed
        assert not re.search(r"_n(m)? = .* at least", f"{issue.key} = {issue.allowed}"), issue
        assert "at most -" not in str(issue)
        less_safe = ["less safe" in one.allowed for one in issue.against if one.allowed]
        assert less_safe == sorted(less_safe)
    assert wrong


def test_a_noise_that_no_sensor_has_is_told_by_itself(tmp_path: Path) -> None:
    path = written(tmp_path, _PIN, "force_sigma_n = 0.1", "force_sigma_n = 10.0")
    (issue,) = problems_before_commissioning(path)
    assert issue.key == "processes.peg-in-hole.force_sigma_n"
    assert issue.allowed.startswith("at most 2")


def test_a_rate_that_is_too_low_is_told_and_no_longer_silence_is_asked_for(tmp_path: Path) -> None:
    path = written(tmp_path, "cell.toml", "rate_hz = 1000", "rate_hz = 1")
    (issue,) = problems_before_commissioning(path)
    assert issue.key == "force_sensors.force.settings.rate_hz"
    assert issue.allowed.startswith("at least 100 samples a second")


def test_a_turn_that_was_left_out_is_named_with_the_pose_that_it_would_have_to_be(
    tmp_path: Path,
) -> None:
    path = written(
        tmp_path,
        "antenna.toml",
        "plug_T_top = [0.0, 0.0, -40.0, 0.0, 0.0, 180.0]",
        "plug_T_top = [0.0, 0.0, -40.0, 0.0, 0.0, 0.0]",
    )
    (issue,) = problems_before_commissioning(path)
    (top,) = [one for one in issue.against if one.key == "recipes.0.plug_T_top"]
    assert top.allowed == "about [0.0, 0.0, -40.0, 0.0, 0.0, 180.0]"
    assert top.line is not None


def test_recipes_of_one_id_are_named_with_their_lines(tmp_path: Path) -> None:
    path = written(tmp_path, _PIN)
    text = path.read_text()
    recipe = text[text.index("[[recipes]]") :].replace("precision pin 6 mm", "another pin")
    path.write_text(f"{text}\n{recipe}")
    found = problems_before_commissioning(path)
    (issue,) = [one for one in found if one.key == "recipes.1.id"]
    assert "'precision pin 6 mm' has 1 already" in issue.allowed
    assert issue.line == path.read_text().count("\n", 0, path.read_text().rindex("id = 1")) + 1
    assert [one.line for one in issue.against] == [text[: text.rindex("id = 1")].count("\n") + 1]
