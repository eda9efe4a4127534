"""Puts the page's process together."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

from fastapi import FastAPI
from starlette.types import ASGIApp

from cellctl.hmi.answers.document import DESCRIPTION, TAGS, operation_id, worded
from cellctl.hmi.archive import ArchiveReader
from cellctl.hmi.daemon_link import DaemonLink
from cellctl.hmi.event_stream import Streams
from cellctl.hmi.hub import Hub
from cellctl.hmi.metrics.keeper import MetricsKeeper
from cellctl.hmi.notifying.notifier import Notifier
from cellctl.hmi.problems import RESPONSES, add_handlers
from cellctl.hmi.routes import (
    alarms,
    calibrations,
    commands,
    exports,
    files,
    line,
    live,
    metrics,
    procedures,
    recall,
    records,
    session,
    time_left,
)
from cellctl.hmi.routes.exports import RunExporter
from cellctl.hmi.routes.time_left import UsualTimes
from cellctl.hmi.settings import LOOPBACK, PageSettings
from cellctl.hmi.shell import Shell
from cellctl.hmi.visitors.access import Gatekeeper
from cellctl.hmi.visitors.people import People
from cellctl.hmi.visitors.rates import RateLimit
from cellctl.hmi.visitors.sessions import Sessions
from cellctl.version import software

COMMANDS_A_MINUTE = 20
SIGN_INS_A_MINUTE = 5


@dataclass(frozen=True, slots=True)
class Parts:
    """What the routes work with."""

    hub: Hub
    link: DaemonLink
    streams: Streams
    gatekeeper: Gatekeeper
    people: People
    sessions: Sessions
    archive: ArchiveReader
    usual: UsualTimes
    exporter: RunExporter
    commands: RateLimit
    sign_ins: RateLimit
    metrics: MetricsKeeper


ROUTERS = (
    session.router, live.router, line.router, metrics.router, commands.router, alarms.router,
    records.router, time_left.router, recall.router, exports.router, calibrations.router,
    procedures.router,
)  # fmt: skip


def hmi_app(settings: PageSettings) -> ASGIApp:
    """What is served: the routes, and what every answer has around it."""
    return Shell(routes(settings), LOOPBACK | frozenset(settings.hosts))


def routes(settings: PageSettings) -> FastAPI:
    """Page and API, which follow the daemon while they are up."""
    hub = Hub()
    notifier = Notifier(hub, settings.notify)
    people, sessions = People(settings.people, settings.tokens), Sessions(settings.idle_s)
    streams, data_dir = Streams(hub), Path(settings.data_dir)
    archive = ArchiveReader(data_dir)
    parts = Parts(
        hub=hub,
        link=DaemonLink(Path(settings.socket), hub),
        streams=streams,
        gatekeeper=Gatekeeper(settings, people, sessions),
        people=people,
        sessions=sessions,
        archive=archive,
        usual=UsualTimes(archive),
        exporter=RunExporter(data_dir),
        commands=RateLimit(COMMANDS_A_MINUTE, 60.0),
        sign_ins=RateLimit(SIGN_INS_A_MINUTE, 60.0),
        metrics=MetricsKeeper(hub, streams, data_dir, Path(settings.forwarder_dir)),
    )

    @asynccontextmanager
    async def following(_app: FastAPI) -> AsyncIterator[None]:
        tasks = [
            asyncio.create_task(parts.link.follow(), name="follow the daemon"),
            asyncio.create_task(notifier.run(), name="tell what happens"),
            asyncio.create_task(parts.metrics.run(), name="count what happens"),
        ]
        try:
            yield
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    # The pages that FastAPI makes of the API load scripts from elsewhere; its document stays.
    app = FastAPI(
        title="cellctl",
        description=DESCRIPTION,
        version=software(),
        openapi_tags=TAGS,
        generate_unique_id_function=operation_id,
        openapi_url="/api/v1/openapi.json",
        docs_url=None,
        redoc_url=None,
        # A redirection names an address as this process sees it, which a proxy may have changed.
        redirect_slashes=False,
        lifespan=following,
        responses=RESPONSES,
    )
    app.state.parts = parts
    add_handlers(app)
    for router in ROUTERS:
        worded(router.routes)
        app.include_router(router, prefix="/api/v1")
    app.include_router(files.router)
    return app
