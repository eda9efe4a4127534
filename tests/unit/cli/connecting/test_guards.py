"""A stop channel is kept until the robots have been asked: its loss would latch an arm."""

import os
import threading
import time
from collections.abc import Iterator

import pytest

from cellctl.cli.connecting.guards import LISTEN_S, felt, heard_from, rate_of
from cellctl.clock import now_s
from cellctl.config.devices import DeviceConfig, ForceSensorConfig
from cellctl.errors.link import LinkLost
from cellctl.interfaces import StopChannel
from cellctl.interfaces.ft_sensor import FtHealth
from cellctl.interfaces.stop_channel import FlangeState

IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


class Channel(StopChannel):
    """Always has a report; counts heartbeats."""

    def __init__(self) -> None:
        self.readable, self._other_end = os.pipe()
        os.write(self._other_end, b"x")
        self.last_beat_s = 0.0
        self.stops = 0

    def open(self) -> None:
        pass

    def close(self) -> None:
        os.close(self.readable)
        os.close(self._other_end)

    def fileno(self) -> int:
        return self.readable

    def request_stop(self) -> None:
        self.stops += 1

    def heartbeat(self) -> None:
        self.last_beat_s = now_s()

    def poll(self) -> FlangeState:
        # The pace of a real channel, which is waited for by its descriptor.
        time.sleep(0.01)
        return FlangeState(now_s(), (0.0, 0.0, 0.0), IDENTITY, moving=False, stop_latched=False)


@pytest.fixture
def channel() -> Iterator[Channel]:
    channel = Channel()
    yield channel
    channel.close()


@pytest.mark.parametrize("end", ["robots_asked", "ended"])
def test_heartbeats_go_on_until_the_robots_were_asked(channel: Channel, end: str) -> None:
    events = {"robots_asked": threading.Event(), "ended": threading.Event()}
    reports: list[FlangeState] = []
    listener = threading.Thread(
        target=lambda: reports.extend(heard_from(channel, **events)), daemon=True
    )
    began_s = now_s()
    listener.start()
    while channel.last_beat_s < began_s + LISTEN_S + 0.3:
        assert listener.is_alive(), "the channel was let go while a robot was still asked"
        time.sleep(0.01)
    events[end].set()
    listener.join(10.0)
    assert not listener.is_alive()
    assert reports
    assert all(report.time_s < began_s + LISTEN_S + 0.3 for report in reports)
    assert channel.stops == 0


@pytest.mark.parametrize(
    ("turns_deg", "said"),
    [
        ((0.0, 0.0, 0.0), "x 1.0  y 2.0  z -30.0 N"),
        ((0.0, 0.0, 180.0), "x 1.0  y -2.0  z 30.0 N"),
        ((90.0, 0.0, 0.0), "x -2.0  y 1.0  z -30.0 N"),
    ],
)
def test_the_force_is_said_in_axes_of_the_flange(
    turns_deg: tuple[float, float, float], said: str
) -> None:
    """A sensor that is written upside down shows a push towards the flange as one away from it."""
    sensor = ForceSensorConfig(
        driver="sri",
        mounted_on="arm",
        flange_T_sensor=(0.0, 0.0, 30.0, *turns_deg),
        stop_channel=DeviceConfig(driver="siasun-sjl"),
    )
    facts = felt([(1.0, 1.0, -29.0), (1.0, 3.0, -31.0)], sensor)
    assert facts["force"].startswith(said)
    assert felt([], sensor) == {}


def test_a_channel_without_a_connection_says_itself_what_it_lost() -> None:
    class Dropped(Channel):
        def fileno(self) -> int:
            return -1

        def poll(self) -> FlangeState:
            raise LinkLost("closed by the robot")

    dropped = Dropped()
    with pytest.raises(LinkLost, match="closed by the robot"):
        heard_from(dropped, threading.Event(), threading.Event())
    dropped.close()


def test_a_rate_that_the_driver_has_not_counted_is_not_0_hz() -> None:
    """A second of samples may be too short for its two windows, and a pause begins them anew."""
    words, notes = rate_of(FtHealth(rate_hz=0.0), 1003, 1000.0)
    assert "Hz" not in words
    assert notes == ()
    assert rate_of(FtHealth(rate_hz=998.2), 500, 1000.0) == ("998.2 Hz by its own count", ())
    _, (note,) = rate_of(FtHealth(rate_hz=0.0), 100, 1000.0)
    assert note == "100.0 Hz measured, the cell file says 1000 Hz"
