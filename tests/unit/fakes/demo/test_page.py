"""The page of a demonstration: its settings are those that `cellctl-hmi` reads."""

from pathlib import Path

from cellctl.hmi.settings import load_settings
from cellctl.hmi.visitors.people import matches
from fakes.demo.page import PEOPLE, DemoPage, write_settings


def test_the_settings_let_the_user_sign_in_with_the_pin_that_is_printed(tmp_path: Path) -> None:
    folder = tmp_path / 'a "folder"'
    folder.mkdir()
    file, pin = write_settings(folder)
    settings = load_settings(file)
    assert settings.socket == str(folder / "store" / "cellctl.sock")
    assert settings.data_dir == str(folder / "store")
    assert {person.name: person.role for person in settings.people} == PEOPLE
    assert matches(pin, settings.people[0].secret)
    assert file.stat().st_mode & 0o077 == 0, "for its user alone"
    words = DemoPage("http://127.0.0.1:1/", pin).words
    assert pin in words
    assert "http://127.0.0.1:1/" in words


def test_every_demonstration_has_a_pin_of_its_own(tmp_path: Path) -> None:
    pins = {write_settings(tmp_path)[1] for _ in range(4)}
    assert len(pins) > 1
