"""Figures for Prometheus."""

from fastapi import APIRouter, Request
from fastapi.responses import Response
from prometheus_client import CONTENT_TYPE_LATEST

from cellctl.hmi.visitors.access import Asked

router = APIRouter(tags=["live"])


@router.get("/metrics", response_class=Response)
async def metrics(request: Request, _visitor: Asked) -> Response:
    """Text form of Prometheus; `docs/metrics.md` has every name with its unit."""
    text = request.app.state.parts.metrics.text()
    return Response(text, media_type=CONTENT_TYPE_LATEST)
