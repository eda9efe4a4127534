"""`cellctl-hmi`: serve the operator page and the HTTP API of one cell."""

import asyncio
import json
import socket
import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer
import uvicorn

from cellctl import log
from cellctl.errors import CellError
from cellctl.errors.local import PageCannotServe
from cellctl.hmi.app import hmi_app
from cellctl.hmi.notifying.notifier import sender_of
from cellctl.hmi.notifying.senders import NotTold
from cellctl.hmi.settings import PageSettings, load_settings
from cellctl.hmi.visitors.people import secret_of

SEND_BUFFER = 64 * 1024
TAKE_TIMEOUT_MS = 10_000
"""A browser that takes nothing for this long has gone."""
CONNECTIONS = 200
PIN_LEAST = 6

app = typer.Typer(
    help="The operator page of a cell: a process beside the daemon.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


@app.command()
def serve(
    settings: Annotated[
        Path | None, typer.Option(help="TOML file; see docs/operator-page.md.")
    ] = None,
    *,
    socket_path: Annotated[str, typer.Option("--socket", help="The daemon's socket.")] = "",
    data_dir: Annotated[str, typer.Option(help="Folder of the run store.")] = "",
    port: Annotated[int | None, typer.Option(help="0 takes a free one.", min=0, max=65535)] = None,
) -> None:
    """Serve until a signal; options go before what the settings say."""
    found = load_settings(settings) if settings is not None else PageSettings()
    changes = {"socket": socket_path or None, "data_dir": data_dir or None, "port": port}
    given = {name: value for name, value in changes.items() if value is not None}
    log.configure()
    run(found.model_copy(update=given))


@app.command()
def secret() -> None:
    """Read a PIN or password from the standard input, and print what the settings keep of it."""
    pin = typer.prompt("PIN", hide_input=True) if sys.stdin.isatty() else sys.stdin.readline()
    pin = pin.strip()
    if len(pin) < PIN_LEAST:
        raise typer.BadParameter(f"at least {PIN_LEAST} characters")
    typer.echo(secret_of(pin))


@app.command("try-notify")
def try_notify(
    settings: Annotated[Path, typer.Option(help="TOML file; see docs/operator-page.md.")],
) -> None:
    """Tell every receiver of the settings once, and say which of them has it."""
    message = {"event": "trial", "cell": "", "time": datetime.now(UTC).isoformat()}
    missed = 0
    for receiver in load_settings(settings).notify:
        sender = sender_of(receiver)
        try:
            asyncio.run(sender.send(message))
        except NotTold as error:
            missed += 1
            typer.echo(f"{sender.name}: not told, {error}")
        else:
            typer.echo(f"{sender.name}: told")
    raise typer.Exit(1 if missed else 0)


def run(settings: PageSettings) -> None:
    """Serve until a signal; raises ``PageCannotServe``."""
    server, listener = page_server(settings)
    asyncio.run(server.serve(sockets=[listener]))


class PageServer(uvicorn.Server):
    """Tells whoever started it where it is: with port 0 nobody else knows the address."""

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Signals are answered from here on, so that no one who was told sends one in vain."""
        await super().startup(sockets)
        for listener in sockets or ():
            typer.echo(json.dumps({"ready": True, "url": url_of(listener)}))
        sys.stdout.flush()


def page_server(
    settings: PageSettings, *, take_timeout_ms: int = TAKE_TIMEOUT_MS
) -> tuple[uvicorn.Server, socket.socket]:
    """The server, and its socket, which takes connections already; raises ``PageCannotServe``.

    ``take_timeout_ms``: how long a browser may take nothing.
    """
    listener = _listener(settings, take_timeout_ms)
    config = uvicorn.Config(
        hmi_app(settings),
        log_config=None,
        access_log=False,
        limit_concurrency=CONNECTIONS,
        timeout_graceful_shutdown=1,
        server_header=False,
        # What a proxy on this PC says of its clients is believed; nobody else's word is.
        forwarded_allow_ips="127.0.0.1",
    )
    return PageServer(config), listener


def url_of(listener: socket.socket) -> str:
    """The address of the page."""
    host, port = listener.getsockname()[:2]
    return f"http://[{host}]:{port}/" if ":" in host else f"http://{host}:{port}/"


def _listener(settings: PageSettings, take_timeout_ms: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
    listener = socket.socket(family, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        # Both go on to the connections. A browser that stops reading must neither fill memory nor
        # stay: uvicorn alone waits for it as long as it likes.
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
        listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, take_timeout_ms)
        listener.bind((settings.host, settings.port))
        listener.listen(CONNECTIONS)
    except OSError as error:
        listener.close()
        raise PageCannotServe(f"{settings.host}:{settings.port}: {error.strerror}") from error
    return listener


def main() -> None:
    """Entry point: numbered faults become one line on stderr and exit code 1."""
    try:
        app()
    except CellError as error:
        typer.echo(f"{error}\n  cause:  {error.cause}\n  remedy: {error.remedy}", err=True)
        sys.exit(1)
