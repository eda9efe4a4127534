"""The two ways to tell somebody: a request to a server, and a program."""

import asyncio
import contextlib
import json
import urllib.error
import urllib.request
from collections.abc import Mapping, Sequence
from http.client import HTTPException
from typing import Any, Protocol

ANSWER_S = 10.0
PROGRAM_S = 30.0
KILLED_S = 5.0


class NotTold(Exception):
    """This try has failed; another may not."""


class Messenger(Protocol):
    """Delivers one message, or raises ``NotTold``."""

    name: str
    """Name in the log, without secrets."""

    async def send(self, message: Mapping[str, Any]) -> None:
        """Deliver; returns when the receiver has it."""
        ...


class WebHook:
    """POSTs the message as JSON; an answer of 200 to 299 means that it has arrived."""

    def __init__(self, url: str, headers: Mapping[str, str]) -> None:
        self.name = urllib.request.Request(url).host or url
        self._url = url
        self._headers = {"Content-Type": "application/json", **headers}
        # Without the handlers of proxies and redirections: the settings alone say who is told, and
        # the headers may hold a secret.
        self._opener = urllib.request.OpenerDirector()
        for handler in (
            urllib.request.HTTPHandler(),
            urllib.request.HTTPSHandler(),
            urllib.request.HTTPDefaultErrorHandler(),
            urllib.request.HTTPErrorProcessor(),
        ):
            self._opener.add_handler(handler)

    async def send(self, message: Mapping[str, Any]) -> None:
        """Deliver in a thread, since the library waits for the network."""
        await asyncio.to_thread(self._post, json.dumps(message).encode())

    def _post(self, body: bytes) -> None:
        request = urllib.request.Request(self._url, body, self._headers, method="POST")
        try:
            with self._opener.open(request, timeout=ANSWER_S):
                return
        except urllib.error.HTTPError as error:
            with error:
                raise NotTold(f"answered {error.code}") from error
        except (OSError, HTTPException, ValueError) as error:
            raise NotTold(str(error) or type(error).__name__) from error


class StartedProgram:
    """Starts a program with the message as JSON on its input; exit code 0 means that it is told."""

    def __init__(
        self, command: Sequence[str], *, allowed_s: float = PROGRAM_S, killed_s: float = KILLED_S
    ) -> None:
        """``killed_s``: how long one that was killed is waited for."""
        self.name = command[0]
        self._command = command
        self._allowed_s = allowed_s
        self._killed_s = killed_s

    async def send(self, message: Mapping[str, Any]) -> None:
        """Deliver; a program that takes too long is ended."""
        try:
            process = await asyncio.create_subprocess_exec(
                *self._command, stdin=asyncio.subprocess.PIPE, start_new_session=True
            )
        except OSError as error:
            raise NotTold(error.strerror or str(error)) from error
        try:
            async with asyncio.timeout(self._allowed_s):
                await process.communicate(json.dumps(message).encode() + b"\n")
        except TimeoutError:
            raise NotTold(f"still running after {self._allowed_s:g} s") from None
        finally:
            if process.returncode is None:
                process.kill()
                # One that hangs in the kernel, at a share that is away for one, does not end even
                # so: what it was to tell is not told, and that is all.
                with contextlib.suppress(TimeoutError):
                    async with asyncio.timeout(self._killed_s):
                        await process.wait()
        if process.returncode:
            raise NotTold(f"exit code {process.returncode}")
