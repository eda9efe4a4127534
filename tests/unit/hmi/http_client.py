"""A browser's requests without a browser."""

import http.client
import json
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

from tests.unit.hmi.scripted_daemon import PIN


@dataclass
class Reply:
    status: int
    headers: dict[str, str]
    body: bytes

    @property
    def json(self) -> Any:
        return json.loads(self.body)


@dataclass
class Client:
    """Keeps its cookie, and says that its own page asks."""

    url: str
    cookie: str = ""
    keys: int = 0
    always: dict[str, str] = field(default_factory=dict)

    def request(self, method: str, path: str, body: Any = None, **headers: str) -> Reply:
        """Headers with underscores for dashes; an empty one is left out."""
        address = urlsplit(self.url).netloc
        connection = http.client.HTTPConnection(address, timeout=60)
        sent = {"Origin": f"http://{address}", "Content-Type": "application/json"} | self.always
        if self.cookie:
            sent["Cookie"] = self.cookie
        sent |= {name.replace("_", "-"): value for name, value in headers.items()}
        data = None if body is None else json.dumps(body).encode()
        try:
            connection.request(method, path, data, {k: v for k, v in sent.items() if v})
            response = connection.getresponse()
            given = {name.lower(): value for name, value in response.getheaders()}
            return Reply(response.status, given, response.read())
        finally:
            connection.close()

    def get(self, path: str, **headers: str) -> Reply:
        return self.request("GET", f"/api/v1/{path}", **headers)

    def sign_in(self, name: str, pin: str = PIN) -> Reply:
        reply = self.request("POST", "/api/v1/session", {"name": name, "pin": pin})
        if reply.status == 200:
            self.cookie = reply.headers["set-cookie"].split(";")[0]
        return reply

    def command(self, wanted: dict[str, Any], decision: int | None = 7, **headers: str) -> Reply:
        self.keys += 1
        headers = {"Idempotency_Key": f"test-key-{self.keys}"} | headers
        body = {"command": wanted, "decision": decision, "reason": "a test"}
        return self.request("POST", "/api/v1/commands", body, **headers)

    def until_live(self) -> None:
        self.until_status(200)

    def until_status(self, status: int) -> None:
        """Wait until the status of the cell answers so."""
        self.until(lambda: self.get("status").status == status)

    def until(self, shown: Callable[[], bool]) -> None:
        """Wait until what the daemon pushed is there."""
        end_s = time.monotonic() + 10
        while not shown():
            assert time.monotonic() < end_s
            time.sleep(0.05)
