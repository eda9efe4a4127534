"""The page's own process takes news from the daemon's snapshot to a receiver's server."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.errors.local import PageSettingsWrong
from cellctl.hmi.main import app
from cellctl.hmi.settings import load_settings
from tests.unit.hmi.http_client import Client
from tests.unit.hmi.notifying.receiver import told_server
from tests.unit.hmi.scripted_daemon import PaperDaemon, alarm, page_thread, serving, snapshot


def test_who_asked_for_alarms_is_told_of_one(tmp_path: Path, paper: PaperDaemon) -> None:
    file = tmp_path / "hmi.toml"
    with told_server() as alarms, told_server() as ends:
        file.write_text(
            f'socket = "{tmp_path}/s"\ndata_dir = "{tmp_path}"\nport = 0\n'
            f'[[notify]]\nurl = "{alarms.url}"\non = ["alarm"]\n'
            f'[[notify]]\nurl = "{ends.url}"\non = ["run_end"]\n'
        )
        paper.snapshot = snapshot(run={**snapshot()["run"], "number": 4})
        with serving(tmp_path / "s", paper), page_thread(file) as url:
            Client(url).until_live()
            # The first look of the notifier is what it compares with.
            first = snapshot(alarms=[alarm(601, "expired", "warn")])
            paper.snapshot = first
            message, _ = alarms.told.get(timeout=30)
            assert (message["event"], message["number"]) == ("alarm", 601)
            paper.snapshot = first | {"run": {**first["run"], "number": 5, "result": "good"}}
            message, _ = ends.told.get(timeout=30)
            assert (message["event"], message["result"]) == ("run_end", "good")
        assert alarms.told.empty()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('url = "http://alerts.example/"', "https://"),
        ('url = "ftp://127.0.0.1/"', "https://"),
        ('url = "https://a.example/"\nprogram = ["true"]', "either url or program"),
        ("", "either url or program"),
        ('program = ["true"]\non = ["every"]', r"notify\.0\.on"),
        ('program = ["true"]\non = []', r"notify\.0\.on"),
    ],
)
def test_receivers_that_cannot_be(tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "hmi.toml"
    file.write_text(f"[[notify]]\n{text}\n")
    with pytest.raises(PageSettingsWrong, match=words):
        load_settings(file)


def test_each_receiver_is_tried(tmp_path: Path) -> None:
    file = tmp_path / "hmi.toml"
    with told_server() as server:
        file.write_text(f'[[notify]]\nurl = "{server.url}"\n[[notify]]\nprogram = ["false"]\n')
        result = CliRunner().invoke(app, ["try-notify", "--settings", str(file)])
        assert server.told.get_nowait()[0]["event"] == "trial"
    assert result.exit_code == 1
    assert ": told\n" in result.output
    assert "false: not told, exit code 1" in result.output
