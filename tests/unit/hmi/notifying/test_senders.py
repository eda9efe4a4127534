"""A message arrives, or the sender says why not."""

import asyncio
import json
import socket
import sys
from pathlib import Path
from typing import Any

import pytest

from cellctl.hmi.notifying.senders import NotTold, StartedProgram, WebHook
from tests.unit.hmi.notifying.receiver import told_server

MESSAGE = {"event": "alarm", "number": 207}


async def test_a_request_has_message_and_headers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("http_proxy", "http://127.0.0.1:9")
    with told_server() as server:
        hook = WebHook(server.url, {"Authorization": "Bearer secret"})
        await hook.send(MESSAGE)
        body, headers = server.told.get_nowait()
    assert body == MESSAGE
    assert headers["Authorization"] == "Bearer secret"
    assert "secret" not in hook.name


@pytest.mark.parametrize("answer", [302, 307, 404, 503])
async def test_another_answer_is_no_success_and_no_redirection_is_followed(answer: int) -> None:
    with told_server() as server:
        server.answers = [answer]
        with pytest.raises(NotTold, match=str(answer)):
            await WebHook(server.url, {}).send(MESSAGE)
        assert server.told.qsize() == 1


async def test_a_server_that_is_not_there() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        url = f"http://127.0.0.1:{taken.getsockname()[1]}/"
        with pytest.raises(NotTold, match="refused"):
            await WebHook(url, {}).send(MESSAGE)


def python(text: str) -> list[str]:
    return [sys.executable, "-c", text]


async def test_a_program_reads_the_message(tmp_path: Path) -> None:
    out = tmp_path / "told"
    text = f"import sys; open({str(out)!r}, 'w').write(sys.stdin.read())"
    await StartedProgram(python(text)).send(MESSAGE)
    assert json.loads(out.read_text()) == MESSAGE


async def test_a_program_that_fails_or_does_not_read() -> None:
    with pytest.raises(NotTold, match="exit code 3"):
        await StartedProgram(python("raise SystemExit(3)")).send(MESSAGE)
    await StartedProgram(["true"]).send({"event": "x" * 1_000_000})
    with pytest.raises(NotTold, match="No such file"):
        await StartedProgram(["/no/such/program"]).send(MESSAGE)


async def test_a_program_that_hangs_is_ended(tmp_path: Path) -> None:
    begun = tmp_path / "begun"
    text = f"import time; open({str(begun)!r}, 'w'); time.sleep(600)"
    with pytest.raises(NotTold, match="still running"):
        await StartedProgram(python(text), allowed_s=1.0).send(MESSAGE)


async def test_a_program_that_does_not_even_end_when_it_is_killed_has_not_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Any other error would end the one who tells, and with it every message to come."""

    class Stuck:
        returncode = None

        async def communicate(self, _data: bytes) -> None:
            await asyncio.sleep(60.0)

        async def wait(self) -> None:
            await asyncio.sleep(60.0)

        def kill(self) -> None:
            pass

    async def started(*_command: str, **_how: Any) -> Stuck:
        return Stuck()

    monkeypatch.setattr(asyncio, "create_subprocess_exec", started)
    with pytest.raises(NotTold, match="still running"):
        await StartedProgram(["at a share"], allowed_s=0.01, killed_s=0.01).send(MESSAGE)
