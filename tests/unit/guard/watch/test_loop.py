"""The loop around the judgement: whatever ends it, the stop goes out first."""

import os
import socket
import threading
from collections.abc import Iterator
from dataclasses import dataclass

import pytest

from cellctl.clock import now_s
from cellctl.errors.force import SensorSetupWrong
from cellctl.guard import ring
from cellctl.guard.limits import GuardLimits
from cellctl.guard.messages import encode, limits_to_json, receive
from cellctl.guard.ring import RingWriter
from cellctl.guard.ring_reader import RingReader
from cellctl.guard.watch.loop import GuardLoop
from cellctl.interfaces.ft_sensor import FtHealth, FtSensor, WrenchSample
from tests.unit.guard.watch.samples import ready_monitor, sample
from tests.unit.guard.watch.test_stop_supervisor import Channel, opened

OVERDUE = GuardLimits(stale_s=1e-9)
"""A silence so short has always passed by the end of the turn in which it is armed."""


class Sensor(FtSensor):
    """Gives a sample at each read, until it is told to fail."""

    def __init__(self) -> None:
        self.fault: Exception | None = None
        self.force = 0.0
        self.closed = False
        self.held = threading.Lock()
        """Taken by a test that lets the loop wait in its next read."""

    def open(self) -> None: ...

    def close(self) -> None:
        self.closed = True

    def fileno(self) -> int:
        return -1

    def read(self, timeout_s: float) -> tuple[WrenchSample, ...]:
        with self.held:
            pass
        if self.fault is not None:
            raise self.fault
        return (sample(now_s(), self.force),)

    def health(self) -> FtHealth:
        return FtHealth()

    def serial_number(self) -> str:
        return "MEMORY"


@dataclass
class Bench:
    sensor: Sensor
    channel: Channel
    loop: GuardLoop
    daemon: socket.socket
    reader: RingReader


@pytest.fixture
def bench() -> Iterator[Bench]:
    descriptor = ring.create(1024)
    daemon, link = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    link.settimeout(0.0)
    daemon.settimeout(2.0)
    sensor, channel = Sensor(), Channel()
    writer, reader = RingWriter(descriptor), RingReader(descriptor)
    loop = GuardLoop(sensor, opened(channel), ready_monitor(), ring=writer, link=link, beat_s=0.002)
    yield Bench(sensor, channel, loop, daemon, reader)
    for end in (daemon, link, writer, reader):
        end.close()
    os.close(descriptor)


def run(bench: Bench) -> threading.Thread:
    thread = threading.Thread(target=bench.loop.run)
    thread.start()
    return thread


def ask(bench: Bench, **request: object) -> dict[str, object]:
    bench.daemon.send(encode({"id": 7, **request}))
    while True:
        message = receive(bench.daemon)
        assert message is not None
        if message.get("id") == 7:
            return message


def event(bench: Bench, kind: str) -> dict[str, object]:
    while True:
        message = receive(bench.daemon)
        assert message is not None
        if message.get("event") == kind:
            return message


def ended(bench: Bench, thread: threading.Thread) -> None:
    thread.join(2)
    assert not thread.is_alive()
    assert bench.channel.stops >= 1


def test_the_end_of_the_daemon(bench: Bench) -> None:
    thread = run(bench)
    bench.daemon.close()
    ended(bench, thread)


def test_a_request_to_quit(bench: Bench) -> None:
    thread = run(bench)
    assert ask(bench, do="quit")["result"] is None
    ended(bench, thread)


def test_a_defect_in_a_driver_ends_the_loop_with_a_stop(bench: Bench) -> None:
    bench.sensor.fault = KeyError("defect")
    with pytest.raises(KeyError):
        bench.loop.run()
    assert bench.channel.stops == 1


def test_a_sensor_that_comes_back_as_another_one(bench: Bench) -> None:
    thread = run(bench)
    assert "result" in ask(bench, do="arm", limits=limits_to_json(GuardLimits(stale_s=1.0)))
    bench.sensor.fault = SensorSetupWrong("rate is 5")
    told = event(bench, "sensor_fault")
    assert (told["number"], told["detail"]) == (506, "rate is 5")
    assert "invalid" in str(event(bench, "trip"))
    assert bench.sensor.closed
    status = bench.reader.status()
    assert status is not None
    assert not status.sensor_open
    bench.daemon.close()
    ended(bench, thread)


def test_a_daemon_that_does_not_read_does_not_hold_the_guard_up(bench: Bench) -> None:
    thread = run(bench)
    for _ in range(50):
        bench.loop.event("filler", text="x" * 8000)
    beats, give_up_s = bench.channel.beats, now_s() + 2.0
    while bench.channel.beats < beats + 10:
        assert now_s() < give_up_s
    bench.daemon.close()
    ended(bench, thread)


@pytest.mark.parametrize(
    "request_",
    [
        {"do": "nonsense"},
        {"do": "arm"},
        {"do": "arm", "limits": {"raw": [1]}},
        {"do": "gravity_compensation", "load": [[1]], "offset": [], "base_down": []},
        {"do": "tare", "duration_s": "long"},
        {"do": "tare", "duration_s": -1.0},
    ],
    ids=str,
)
def test_requests_that_make_no_sense_are_refused(bench: Bench, request_: dict[str, object]) -> None:
    thread = run(bench)
    assert ask(bench, **request_)["refused"]
    bench.daemon.close()
    ended(bench, thread)


def test_a_trip_sends_the_stop_before_it_is_told(bench: Bench) -> None:
    thread = run(bench)
    limits = GuardLimits(raw=(20.0,) * 6, stale_s=1.0)
    assert "result" in ask(bench, do="arm", limits=limits_to_json(limits))
    bench.sensor.force = 30.0
    event(bench, "trip")
    assert bench.channel.stops >= 1
    status = bench.reader.status()
    assert status is not None
    assert status.latched == 1
    bench.daemon.close()
    ended(bench, thread)


def test_a_new_trip_right_after_an_acknowledge_is_stopped_as_well(bench: Bench) -> None:
    """Acknowledge and arm may wait in the socket together, and the arming may trip at once."""
    thread = run(bench)
    limits = limits_to_json(GuardLimits(raw=(20.0,) * 6, stale_s=1.0))
    assert "result" in ask(bench, do="arm", limits=limits)
    bench.sensor.force = 30.0
    first = event(bench, "trip")
    # Both wait in the link when the loop takes its next turn: no turn lies between them.
    with bench.sensor.held:
        bench.daemon.send(encode({"id": 1, "do": "acknowledge"}))
        bench.daemon.send(encode({"id": 2, "do": "arm", "limits": limits_to_json(OVERDUE)}))
    second = event(bench, "trip")
    assert (first["trip"]["reason"], second["trip"]["reason"]) == ("raw limit", "sensor silent")  # type: ignore[index]
    bench.daemon.close()
    ended(bench, thread)
