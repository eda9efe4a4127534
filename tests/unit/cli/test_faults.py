"""`cellctl faults`: one fault in words, and all of them for programs."""

import json

import pytest
from rich.cells import cell_len
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.fault_catalogue import known_faults
from cellctl.translations import fault_words


def said(*words: str) -> str:
    done = CliRunner().invoke(whole_app(), ["faults", *words])
    assert done.exit_code == 0, done.output
    return done.stdout


def test_one_fault_has_its_cause_and_remedy() -> None:
    fault = next(one for one in known_faults() if one.number == 207)
    text = said("207")
    for words in ("F207", fault.text, fault.cause, fault.remedy, fault.reaction.value):
        assert words in text
    assert "F206" not in text


def test_a_terminal_shows_all_of_them_as_it_shows_one() -> None:
    one = said("207")
    terminal = CliRunner(env={"FORCE_COLOR": "1", "COLUMNS": "80", "NO_COLOR": "1"})
    shown = terminal.invoke(whole_app(), ["faults"]).stdout
    assert "| number |" in said(), "a file is the page"
    assert "|" not in shown.split("F208", 1)[0].split("F207", 1)[1]
    assert " ".join(one.split()) in " ".join(shown.split())
    assert max(cell_len(line) for line in shown.splitlines()) <= 80


@pytest.mark.parametrize("written", ["F207", "f207"])
def test_a_number_is_taken_as_people_write_it(written: str) -> None:
    assert said(written) == said("207")


@pytest.mark.parametrize("written", ["G207", "F", "20.7", "two"])
def test_what_is_no_number_is_refused(written: str) -> None:
    done = CliRunner().invoke(whole_app(), ["faults", written])
    assert done.exit_code == 2
    assert "such as F529" in done.output


def test_one_fault_is_told_in_chinese() -> None:
    fault = next(one for one in known_faults() if one.number == 207)
    chinese = fault_words(fault, "zh")
    text = said("207", "--lang", "zh")
    for words in ("F207", chinese.text, chinese.cause, chinese.remedy):
        assert words in text
    assert fault.cause not in text
    plain = json.loads(said("207", "--lang", "zh", "--json"))[0]
    assert (plain["text"], plain["reaction"]) == (chinese.text, fault.reaction.value)


def test_every_fault_is_there_for_programs() -> None:
    document = json.loads(said("--json"))
    assert [one["number"] for one in document] == [fault.number for fault in known_faults()]
    assert [one["number"] for one in json.loads(said("207", "--json"))] == [207]


def test_a_number_that_there_is_not_names_its_neighbours() -> None:
    done = CliRunner().invoke(whole_app(), ["faults", "299"])
    assert done.exit_code == 2
    assert "207" in done.output
