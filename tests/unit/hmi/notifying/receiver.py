"""A server that is told things, and answers as a test says."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, HTTPServer
from queue import Queue
from typing import Any


@dataclass
class ToldServer:
    url: str = ""
    answers: list[int] = field(default_factory=list)
    """Answers to the next requests; 204 when there are no more."""
    told: Queue[tuple[dict[str, Any], dict[str, str]]] = field(default_factory=Queue)
    """Message and headers of every request."""


@contextmanager
def told_server() -> Iterator[ToldServer]:
    server = ToldServer()

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"]))
            server.told.put((json.loads(body), dict(self.headers)))
            self.send_response(server.answers.pop(0) if server.answers else 204)
            self.send_header("Location", server.url + "elsewhere")
            self.send_header("Content-Length", "0")
            self.end_headers()

        def log_message(self, *_arguments: object) -> None:
            """Nothing: the test says what went wrong."""

    with HTTPServer(("127.0.0.1", 0), Handler) as listener:
        server.url = f"http://127.0.0.1:{listener.server_port}/"
        thread = threading.Thread(target=listener.serve_forever, daemon=True)
        thread.start()
        yield server
        listener.shutdown()
        thread.join()
