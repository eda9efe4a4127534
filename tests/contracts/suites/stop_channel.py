"""What every stop channel of the guard must do. The interface blocks, so these tests do too."""

import contextlib
import select
import time
from abc import ABC, abstractmethod
from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.clock import now_s
from cellctl.errors.link import LinkError
from cellctl.interfaces.stop_channel import FlangeState, StopChannel


class StopBench(ABC):
    """A channel under test, not opened, to a robot that this bench can set in motion."""

    channel: StopChannel

    @abstractmethod
    def start_motion(self) -> None:
        """The robot begins a motion of several seconds."""

    @abstractmethod
    def moving(self) -> bool:
        """Whether the arm moves, whatever the driver says."""

    @abstractmethod
    def flange(self) -> RigidTransform:
        """``base_T_flange``, whatever the driver says; turned so that its matrix differs from its
        transpose."""

    @abstractmethod
    def flood(self) -> None:
        """The controller sends as many reports at once as the sockets hold, some megabytes."""

    @abstractmethod
    def cut(self) -> None:
        """Break the link. The controller comes back by itself."""


class StopChannelContract(ABC):
    """Written once; no clause may be left out by a driver."""

    @pytest.fixture
    @abstractmethod
    def bench(self) -> StopBench:
        """A fresh bench, torn down after the test."""

    @pytest.fixture
    def opened(self, bench: StopBench) -> StopBench:
        bench.channel.open()
        return bench

    @staticmethod
    def watch(
        bench: StopBench, seen: Callable[[FlangeState], bool], limit_s: float = 2.0
    ) -> FlangeState:
        """Beat and read, as the guard does, until a report meets a condition."""
        deadline_s = time.monotonic() + limit_s
        while time.monotonic() < deadline_s:
            bench.channel.heartbeat()
            select.select([bench.channel], [], [], 0.05)
            state = bench.channel.poll()
            if state is not None and seen(state):
                return state
        raise AssertionError("not reported in time")

    def test_close_in_any_state(self, bench: StopBench) -> None:
        bench.channel.close()
        assert bench.channel.fileno() == -1
        bench.channel.open()
        assert bench.channel.fileno() >= 0
        bench.channel.close()
        bench.channel.close()
        for act in (bench.channel.poll, bench.channel.heartbeat, bench.channel.request_stop):
            with pytest.raises(LinkError):
                act()

    def test_opening_never_moves(self, bench: StopBench) -> None:
        bench.channel.open()
        state = self.watch(bench, lambda _: True)
        assert not state.moving
        assert not bench.moving()

    def test_reports_are_fresh_and_well_formed(self, opened: StopBench) -> None:
        state = self.watch(opened, lambda _: True)
        assert 0.0 <= now_s() - state.time_s < 0.25
        assert len(state.position_m) == 3
        rotation = np.reshape(state.rotation, (3, 3))
        assert np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-9)
        assert np.linalg.det(rotation) == pytest.approx(1.0)
        flange = opened.flange()
        there = flange.rotation.as_matrix()
        assert not np.allclose(there, there.T, atol=1e-3), "this bench would hide a transpose"
        assert np.allclose(rotation, there, atol=1e-4)
        assert np.allclose(state.position_m, flange.translation, atol=1e-5)

    def test_poll_does_not_block(self, opened: StopBench) -> None:
        self.watch(opened, lambda _: True)
        start_s = time.monotonic()
        for _ in range(10):
            opened.channel.poll()
        assert time.monotonic() - start_s < 0.1

    def test_poll_reads_a_bounded_amount(self, opened: StopBench) -> None:
        """A robot that floods the channel must not keep the guard from its samples. A channel may
        take a flood for a fault."""
        self.watch(opened, lambda _: True)
        opened.flood()
        longest_s, deadline_s = 0.0, time.monotonic() + 1.0
        with contextlib.suppress(LinkError):
            while time.monotonic() < deadline_s:
                opened.channel.heartbeat()
                # What this thread has computed: how busy the PC is does not count.
                before_s = time.thread_time()
                try:
                    opened.channel.poll()
                finally:
                    longest_s = max(longest_s, time.thread_time() - before_s)
                time.sleep(0.02)
        assert longest_s < 0.1

    def test_stop_works_twice_and_latches(self, opened: StopBench) -> None:
        opened.channel.request_stop()
        opened.channel.request_stop()
        self.watch(opened, lambda state: state.stop_latched and not state.moving)

    def test_stop_ends_a_motion(self, opened: StopBench) -> None:
        opened.start_motion()
        self.watch(opened, lambda state: state.moving)
        start_s = time.monotonic()
        opened.channel.request_stop()
        assert time.monotonic() - start_s < 0.05, "the request must not wait for standstill"
        self.watch(opened, lambda state: state.stop_latched and not state.moving)
        assert not opened.moving()

    def test_the_robot_stops_when_heartbeats_stay_away(self, opened: StopBench) -> None:
        opened.start_motion()
        self.watch(opened, lambda state: state.moving)
        deadline_s = time.monotonic() + 2.0
        while opened.moving():
            assert time.monotonic() < deadline_s, "still moving without heartbeats"
            select.select([opened.channel], [], [], 0.05)
            opened.channel.poll()

    def test_a_broken_link_is_a_fault_and_stops_the_robot(self, opened: StopBench) -> None:
        opened.start_motion()
        self.watch(opened, lambda state: state.moving)
        opened.cut()
        with pytest.raises(LinkError):
            self.watch(opened, lambda _: False)
        assert opened.channel.fileno() == -1
        opened.channel.open()
        self.watch(opened, lambda state: state.stop_latched and not state.moving)
