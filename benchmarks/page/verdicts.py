"""How long a command takes to its verdict, from a browser's place to the daemon and back."""

import http.client
import json
import threading
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from urllib.parse import urlsplit

from benchmarks.page.readers import token

EVERY_S = 0.5
_A_MINUTE = 15
"""Commands of one program: the page lets it give twenty."""
PROGRAMS = round(60.0 / EVERY_S / _A_MINUTE)
"""So many take turns."""
ANSWER_S = 10.0
REFUSED = 403
"""The daemon's answer to somebody who may only look on. Nothing in the cell changes by it."""


@dataclass
class Verdicts:
    """What one client was answered."""

    took_s: list[float] = field(default_factory=list)
    odd: list[str] = field(default_factory=list)
    """Answers that are no verdict of the daemon."""


@contextmanager
def commanded(url: str) -> Iterator[Verdicts]:
    """Give a command that is refused every half second meanwhile; none without an address."""
    found, over = Verdicts(), threading.Event()
    client = threading.Thread(target=_command, args=(url, found, over), name="give commands")
    if url:
        client.start()
    try:
        yield found
    finally:
        over.set()
        if url:
            client.join()


def _command(url: str, found: Verdicts, over: threading.Event) -> None:
    address = urlsplit(url)
    number = 0
    while not over.wait(EVERY_S):
        connection = http.client.HTTPConnection(address.netloc, timeout=ANSWER_S)
        headers = {
            "Authorization": f"Bearer {token(number % PROGRAMS)}",
            "Content-Type": "application/json",
            "Idempotency-Key": uuid.uuid4().hex,
        }
        body = json.dumps({"command": {"request": "hold"}, "decision": 0})
        begun_s = time.monotonic()
        try:
            connection.request("POST", "/api/v1/commands", body, headers)
            answer = connection.getresponse()
            said = answer.read()
        except OSError as error:
            found.odd.append(repr(error))
            continue
        finally:
            connection.close()
        found.took_s.append(time.monotonic() - begun_s)
        if answer.status != REFUSED or b"reject_code" not in said:
            found.odd.append(f"{answer.status} {said[:200]!r}")
        number += 1
