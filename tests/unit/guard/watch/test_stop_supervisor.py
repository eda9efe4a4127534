"""The hold on the stop channel, against a channel of memory."""

import threading

import pytest

from cellctl.errors.internal import Unexpected
from cellctl.errors.link import ConnectTimeout, LinkLost
from cellctl.guard.watch.stop_supervisor import STAND_S, StopSupervisor
from cellctl.interfaces.stop_channel import FlangeState, StopChannel
from tests.unit.guard.watch.samples import flange


class Channel(StopChannel):
    """Counts what it is told and reports what a test puts in."""

    def __init__(self) -> None:
        self.stops = self.beats = self.closed = self.opened = 0
        self.state: FlangeState | None = None
        self.broken = False
        self.absent = False
        self.defect: Exception | None = None
        self.gate = threading.Event()
        self.gate.set()

    def open(self) -> None:
        assert self.gate.wait(5)
        self.opened += 1
        if self.defect is not None:
            raise self.defect
        if self.absent:
            raise ConnectTimeout("nobody came")

    def close(self) -> None:
        self.closed += 1

    def fileno(self) -> int:
        return -1

    def request_stop(self) -> None:
        self._check()
        self.stops += 1

    def heartbeat(self) -> None:
        self._check()
        self.beats += 1

    def poll(self) -> FlangeState | None:
        self._check()
        state, self.state = self.state, None
        return state

    def _check(self) -> None:
        if self.broken:
            raise LinkLost("gone")


def opened(channel: Channel) -> StopSupervisor:
    supervisor = StopSupervisor(channel, confirm_s=0.1)
    supervisor.open()
    settle(supervisor)
    return supervisor


def settle(supervisor: StopSupervisor) -> None:
    """Wait until the opener's thread has handed over."""
    opener = supervisor._opener
    assert opener is not None
    opener.join(5)
    supervisor.poll(0.0)
    assert supervisor._opener is None


def test_without_a_channel_it_is_up_and_does_nothing() -> None:
    supervisor = StopSupervisor(None, confirm_s=0.1)
    supervisor.open()
    supervisor.stop(0.0)
    supervisor.beat(0.0)
    assert (supervisor.up, supervisor.present, supervisor.poll(0.0)) == (True, False, None)
    supervisor.close()


def test_opening_does_not_block() -> None:
    channel = Channel()
    channel.gate.clear()
    supervisor = StopSupervisor(channel, confirm_s=0.1)
    supervisor.open()
    supervisor.poll(0.0)
    assert not supervisor.up
    assert supervisor._opener is not None
    channel.gate.set()
    settle(supervisor)
    assert (supervisor.up, supervisor.fault) == (True, None)


def test_beats_go_out() -> None:
    channel = Channel()
    supervisor = opened(channel)
    for k in range(5):
        supervisor.beat(k * 0.02)
    assert (channel.beats, channel.stops) == (5, 0)


def test_a_stop_is_repeated_until_the_robot_has_latched() -> None:
    channel = Channel()
    supervisor = opened(channel)
    supervisor.stop(1.0)
    assert channel.stops == 1
    supervisor.beat(1.02)
    channel.state = flange(1.03)
    supervisor.poll(1.03)
    supervisor.beat(1.04)
    assert channel.stops == 3
    channel.state = flange(1.05)._replace(stop_latched=True)
    supervisor.poll(1.05)
    supervisor.beat(1.06)
    assert (channel.stops, channel.beats) == (3, 3)


def test_a_stop_that_is_ignored_ends_the_beats() -> None:
    channel = Channel()
    supervisor = opened(channel)
    supervisor.stop(1.0)
    for k in range(1, 20):
        supervisor.beat(1.0 + k * 0.02)
    assert channel.stops == 20
    assert channel.beats == pytest.approx(5, abs=1)


def test_a_robot_that_has_latched_a_stop_and_moves_on_gets_no_more_beats() -> None:
    """It was taken for one that stands, and its dead man was fed for ever."""
    channel = Channel()
    supervisor = opened(channel)
    supervisor.stop(1.0)
    for k in range(1, 300):
        time_s = 1.0 + k * 0.02
        channel.state = flange(time_s)._replace(stop_latched=True, moving=True)
        supervisor.poll(time_s)
        supervisor.beat(time_s)
    assert channel.beats == pytest.approx(STAND_S / 0.02, abs=1), "while it may still be braking"
    assert channel.stops == pytest.approx(1 + 299 - STAND_S / 0.02, abs=2)


def test_an_arm_that_has_stood_may_be_jogged_under_its_latch() -> None:
    channel = Channel()
    supervisor = opened(channel)
    supervisor.stop(1.0)
    for k in range(1, 300):
        time_s = 1.0 + k * 0.02
        channel.state = flange(time_s)._replace(stop_latched=True, moving=k != 20)
        supervisor.poll(time_s)
        supervisor.beat(time_s)
    assert (channel.beats, channel.stops) == (299, 1)


def test_a_latch_that_somebody_released_behind_the_guard_s_back_is_stopped_again() -> None:
    channel = Channel()
    supervisor = opened(channel)
    supervisor.stop(1.0)
    channel.state = flange(1.01)._replace(stop_latched=True)
    supervisor.poll(1.01)
    channel.state = flange(2.0)
    supervisor.poll(2.0)
    supervisor.beat(2.0)
    assert channel.stops == 2
    supervisor.release()
    supervisor.beat(2.02)
    assert channel.stops == 2


def test_a_lost_channel_is_closed_and_opened_again_with_the_stop_still_wanted() -> None:
    channel = Channel()
    supervisor = opened(channel)
    channel.broken = True
    supervisor.stop(1.0)
    assert (supervisor.up, channel.closed) == (False, 1)
    assert isinstance(supervisor.fault, LinkLost)
    channel.broken = False
    supervisor.poll(1.0)
    settle(supervisor)
    supervisor.beat(1.5)
    assert channel.stops == 1


def test_a_robot_that_does_not_come_is_waited_for_with_pauses() -> None:
    channel = Channel()
    channel.absent = True
    supervisor = opened(channel)
    assert isinstance(supervisor.fault, ConnectTimeout)
    supervisor.poll(0.1)
    assert (supervisor._opener, channel.opened) == (None, 1)
    supervisor.poll(1.0)
    assert supervisor._opener is not None
    settle(supervisor)


def test_a_defect_of_the_driver_is_a_fault_of_the_channel_and_tried_again() -> None:
    channel = Channel()
    channel.defect = KeyError("defect")
    supervisor = opened(channel)
    assert not supervisor.up
    assert isinstance(supervisor.fault, Unexpected)
    channel.defect = None
    supervisor.poll(1.0)
    settle(supervisor)
    assert supervisor.up
