"""A camera or a stereo head of the fake cell behind the fake GenTL producer.

The cameras of a head that expose at the same time see the same moment of the world: it is rendered
once, as it is for a frame server.
"""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fakes.gentl.exposures import Asked, Exposed, Outcome
from fakes.gentl.layout import laid_out
from fakes.render.worker import Frame
from fakes.wire.cameras.gentl_faults import GentlFaults, delay_s, outcome
from fakes.wire.cameras.rendering import ExposureError

TOGETHER_S = 0.1
"""Exposures of a head that begin within this time are of one moment. Two triggers in a row are some
milliseconds apart on a busy PC."""

Take = Callable[[frozenset[str], float], Awaitable[Frame]]
"""Takes a picture of the scene as it is now, with the named faults of scene and picture, and so
many times as bright as usual. Raises ``ExposureError``."""


@dataclass(slots=True, eq=False)
class _Moment:
    """What the cameras of a head expose together."""

    asked: Asked
    faults: dict[str, float]
    outcome: Outcome | None
    taking: asyncio.Task[Frame] | None = None
    """The picture that is being taken; None until the first camera needs it."""
    taken_by: set[int] = field(default_factory=set)

    def shared_by(self, lens: int, asked: Asked) -> bool:
        """Whether a camera that asks now exposes in this moment too."""
        mine, its = self.asked, asked
        alike = (mine.exposure_us, mine.gain_db) == (its.exposure_us, its.gain_db)
        together = abs(its.begun_s - mine.begun_s) < TOGETHER_S
        return alike and together and lens not in self.taken_by


class GentlCamera:
    """One lens or two, left and right."""

    def __init__(self, take: Take, faults: GentlFaults, *, lenses: int, exposure_us: float) -> None:
        """``exposure_us`` is the exposure that the rendering is made for."""
        self.faults = faults
        self._take = take
        self._lenses = lenses
        self._usual_us = exposure_us
        self._moment: _Moment | None = None
        self._last: dict[int, Exposed] = {}

    async def expose(self, lens: int, asked: Asked) -> Exposed | None:
        """The image of one camera; None when none comes."""
        moment = self._moment_of(lens, asked)
        if moment.outcome is None:
            return None
        if moment.outcome is Outcome.LOST:
            return Exposed(Outcome.LOST)
        if moment.outcome is Outcome.STALE and lens in self._last:
            return self._last[lens]
        try:
            frame = await self._frame(moment)
        except ExposureError:
            return None
        picture = self._picture(frame, lens)
        if "wrong_size" in moment.faults:
            picture = picture[: frame.height // 2, : frame.width // 2]
        exposed = _delivered(picture, asked, moment.outcome)
        await asyncio.sleep(delay_s(moment.faults, len(exposed.data)))
        self._last[lens] = Exposed(Outcome.STALE, exposed.size_px, exposed.data)
        return exposed

    def stop(self) -> None:
        """Nobody waits any more for what is being rendered."""
        if self._moment is not None and self._moment.taking is not None:
            self._moment.taking.cancel()

    def _moment_of(self, lens: int, asked: Asked) -> _Moment:
        moment = self._moment
        if moment is None or not moment.shared_by(lens, asked):
            self._moment = moment = self._begun(asked)
        moment.taken_by.add(lens)
        return moment

    def _begun(self, asked: Asked) -> _Moment:
        faults = self.faults.take()
        return _Moment(asked, faults, outcome(faults))

    async def _frame(self, moment: _Moment) -> Frame:
        if moment.taking is None:
            take = self._take(frozenset(moment.faults), self._brightness(moment.asked))
            moment.taking = asyncio.ensure_future(take)
        # The other camera of the head may still wait for it when this one has given up.
        return await asyncio.shield(moment.taking)

    def _brightness(self, asked: Asked) -> float:
        return asked.exposure_us / self._usual_us * 10 ** (asked.gain_db / 20)

    def _picture(self, frame: Frame, lens: int) -> NDArray[np.uint8]:
        pixels = np.frombuffer(frame.payload, np.uint8)
        channels = pixels.size // (self._lenses * frame.height * frame.width)
        shape = (self._lenses, frame.height, frame.width)
        images = pixels.reshape(shape if channels == 1 else (*shape, channels))
        return np.asarray(images[lens], dtype=np.uint8)


def _delivered(picture: NDArray[np.uint8], asked: Asked, what: Outcome) -> Exposed:
    """The region that is read out, as far as there is a picture."""
    (x, y), (width, height) = asked.offset_px, asked.size_px
    region = picture[y : y + height, x : x + width]
    size_px = (region.shape[1], region.shape[0])
    return Exposed(what, size_px, laid_out(region, asked.pixel_format))
