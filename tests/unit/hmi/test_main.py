"""The command `cellctl-hmi`: settings, secrets, a port that is taken, what it loads."""

import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from cellctl.errors.local import PageCannotServe, PageSettingsWrong
from cellctl.hmi.main import app, page_server
from cellctl.hmi.settings import PageSettings, load_settings
from cellctl.hmi.visitors.hosts import host_name
from cellctl.hmi.visitors.people import matches, secret_of
from cellctl.hmi.visitors.rates import RateLimit
from cellctl.hmi.visitors.sessions import Sessions
from tests.unit.hmi.scripted_daemon import page_process


def test_a_secret_is_that_of_its_pin_alone() -> None:
    printed = CliRunner().invoke(app, ["secret"], input="135790\n")
    assert printed.exit_code == 0
    secret = printed.stdout.strip()
    assert "135790" not in secret
    assert matches("135790", secret)
    assert not matches("135791", secret)
    assert secret_of("135790") != secret, "salted"
    assert CliRunner().invoke(app, ["secret"], input="123\n").exit_code != 0


@given(st.text())
def test_what_is_no_secret_matches_nothing(text: str) -> None:
    assert not matches("135790", text.replace("scrypt", ""))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("port = ", "hmi.toml"),
        ("prot = 1", "prot: Extra inputs"),
        ("port = 70000", "port: "),
        ('[[people]]\nname = "a b"\nrole = "view"\nsecret = ""', "people.0.name"),
        ('[[people]]\nname = "a"\nrole = "boss"\nsecret = ""', "people.0.role"),
    ],
)
def test_wrong_settings_are_named(tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "hmi.toml"
    file.write_text(text)
    with pytest.raises(PageSettingsWrong, match=words):
        load_settings(file)


def test_missing_settings_are_named(tmp_path: Path) -> None:
    with pytest.raises(PageSettingsWrong, match=r"none\.toml"):
        load_settings(tmp_path / "none.toml")


def test_a_port_that_is_taken_is_named() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(PageCannotServe, match=str(port)):
            page_server(PageSettings(port=port))


@pytest.mark.parametrize(
    ("header", "name"),
    [("a:1", "a"), ("a", "a"), ("[::1]:80", "::1"), ("[::1]", "::1"), ("", "")],
)
def test_host_names(header: str, name: str) -> None:
    assert host_name(header) == name


def test_an_idle_session_only_shows() -> None:
    time_s = 1000.0
    sessions = Sessions(idle_s=600, clock=lambda: time_s)
    secret = sessions.open("anna", "operate")
    session = sessions.find(secret)
    assert session is not None
    assert sessions.role(session) == "operate"
    time_s += 601
    assert sessions.role(session) == "view"
    session.used_s = time_s
    assert sessions.role(session) == "operate"
    time_s += 13 * 3600
    assert sessions.find(secret) is None
    assert sessions.find("") is None


def test_a_limit_counts_each_key_alone() -> None:
    time_s = 0.0
    limit = RateLimit(2, 60.0, clock=lambda: time_s)
    assert [limit.wait_s("a") for _ in range(3)] == [0, 0, 60]
    assert limit.wait_s("b") == 0
    time_s = 20.0
    assert limit.wait_s("a") == 40
    time_s = 61.0
    assert limit.wait_s("a") == 0


def test_the_process_ends_at_once_when_told(settings: Path) -> None:
    for number, codes in ((signal.SIGTERM, (0, -signal.SIGTERM)), (signal.SIGINT, (0, 130))):
        with page_process(settings) as (process, _):
            process.send_signal(number)
            assert process.wait(10) in codes


def test_the_daemon_loads_nothing_of_the_page() -> None:
    code = "import sys, cellctl.daemon.app; print([m for m in sys.modules if 'fastapi' in m])"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=os.environ
    )
    assert done.stdout.strip() == "[]"


def test_the_unit_allows_the_page_no_more_than_it_needs() -> None:
    unit = (Path(__file__).parents[3] / "systemd/cellctl-hmi.service").read_text("utf-8")
    for line in (
        "User=cellctl-hmi",
        "CapabilityBoundingSet=\n",
        "ProtectSystem=strict",
        "IPAddressDeny=any",
        "MemoryMax=300M",
        "CPUQuota=50%",
    ):
        assert line in unit
    assert f"SocketBindAllow=tcp:{PageSettings().port}\n" in unit
