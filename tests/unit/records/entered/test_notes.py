"""Notes on a run: plausible values of an existing run, by somebody with a name."""

import pytest

from cellctl.errors.records.store import RunUnknown, ValueRefused
from cellctl.records import RunStore
from cellctl.records.entered.notes import add_note, note_words, notes_of, surroundings
from cellctl.records.entered.said_by import said_by
from tests.unit.records.conftest import start

ROOT = "terminal:root"


def test_the_newest_value_counts_and_all_are_kept(store: RunStore) -> None:
    run = start(store)
    add_note(store, run, ROOT, "anna", {"temperature_deg_c": 12.0, "pressure_hpa": 1013.2})
    add_note(store, run, ROOT, "bo", {"temperature_deg_c": 21.0}, instrument="TH-3", remark="again")
    notes = notes_of(run, store.audit_log())
    assert [note_words(note) for note in notes] == [
        "temperature 12 °C, air pressure 1013.2 hPa",
        "temperature 21 °C, instrument TH-3, again",
    ]
    found = surroundings(notes)
    assert {key: (one.value, said_by(one.entry)) for key, one in found.items()} == {
        "temperature_deg_c": (21.0, "bo, typed by terminal:root"),
        "pressure_hpa": (1013.2, "anna, typed by terminal:root"),
    }
    assert found["temperature_deg_c"].instrument == "TH-3"


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("temperature_deg_c", 293.0),
        ("temperature_deg_c", float("nan")),
        ("humidity_percent", -0.1),
        ("humidity_percent", 100.1),
        ("humidity_percent", 1.9),
        ("pressure_hpa", 101325.0),
        ("pressure_hpa", 1.013),
    ],
)
def test_what_cannot_be_so_is_refused(store: RunStore, key: str, value: float) -> None:
    run = start(store)
    with pytest.raises(ValueRefused, match="allowed"):
        add_note(store, run, ROOT, "anna", {key: value})
    assert store.audit_log() == []


def test_a_humidity_as_a_share_of_one_is_refused_with_what_was_meant(store: RunStore) -> None:
    run = start(store)
    with pytest.raises(ValueRefused, match=r"0\.45 %, allowed 2 to 100; did you mean 45 %\?"):
        add_note(store, run, ROOT, "anna", {"humidity_percent": 0.45})
    assert store.audit_log() == []


def test_a_note_says_something_about_a_run_that_there_is(store: RunStore) -> None:
    run = start(store)
    with pytest.raises(ValueRefused, match="a value or a remark"):
        add_note(store, run, ROOT, "anna", {})
    with pytest.raises(ValueRefused, match="who made it"):
        add_note(store, run, ROOT, "", {}, remark="door was open")
    with pytest.raises(RunUnknown):
        add_note(store, run + 1, ROOT, "anna", {}, remark="door was open")
    assert store.audit_log() == []
