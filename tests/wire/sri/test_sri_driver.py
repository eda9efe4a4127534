"""Driver and fake box over TCP, serial and CAN, with every fault of the box."""

import asyncio
import itertools
from collections.abc import AsyncIterator
from typing import Any

import can
import pytest

from cellctl.errors.force import SensorSetupWrong
from cellctl.errors.link import ConnectTimeout, LinkLost, ReplyTimeout, StaleData
from drivers.ftsensor.sri.driver import SriSensor
from fakes.wire.sri.box import SriBox
from tests.rigs.wire.ports import free_ports
from tests.wire.sri.sri_rig import WRENCH, blocking, noisy, read_until, tcp_sensor


@pytest.fixture
async def box() -> AsyncIterator[SriBox]:
    box = SriBox(noisy)
    yield box
    await box.stop()


async def opened(sensor: SriSensor) -> SriSensor:
    await blocking(sensor.open)
    return sensor


async def closed(sensor: SriSensor) -> None:
    await blocking(sensor.close)


async def some(sensor: SriSensor, count: int = 20) -> list[Any]:
    start = sensor.health().samples
    return await read_until(sensor, lambda: sensor.health().samples >= start + count)


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"check": "CRC32"},
        {"unit": "C"},
        {"unit": "M"},
        {"points": 5},
        {"unit": "C", "points": 3, "check": "CRC32"},
        {"filter_weights": (1, 1, 2)},
    ],
    ids=str,
)
async def test_every_format(box: SriBox, settings: dict[str, Any]) -> None:
    sensor = await opened(await tcp_sensor(box, **settings))
    samples = await some(sensor)
    assert samples[-1][3:9] == pytest.approx(WRENCH, rel=2e-3, abs=0.5)
    assert sensor.health().lost == 0
    assert "M8128B1-FAKE" in sensor.serial_number()
    await closed(sensor)
    assert sensor.fileno() == -1


async def test_times_and_numbers(box: SriBox) -> None:
    sensor = await opened(await tcp_sensor(box))
    samples = await some(sensor, 100)
    steps = [(b.number - a.number) % 65536 for a, b in itertools.pairwise(samples)]
    assert set(steps) == {1}
    assert all(s.time_s <= s.receive_time_s + 1e-3 for s in samples)
    await closed(sensor)


async def test_serial(box: SriBox) -> None:
    path = await box.start_serial(115200)
    sensor = SriSensor(SriSensor.Config(transport="serial", device=path, rate_hz=300))
    await opened(sensor)
    samples = await some(sensor, 50)
    assert samples[-1][3:9] == pytest.approx(WRENCH, rel=2e-3, abs=0.5)
    await closed(sensor)


async def test_can_on_any_bus(box: SriBox) -> None:
    with can.Bus("sri-test", interface="virtual") as bus:
        await box.start_can(bus)
        config = SriSensor.Config(
            transport="can", can_interface="virtual", can_channel="sri-test", rate_hz=200
        )
        sensor = await opened(SriSensor(config))
        samples = await some(sensor)
        assert samples[-1][3:9] == pytest.approx(WRENCH, rel=2e-3, abs=0.5)
        box.faults.inject("skip_every", 3)
        await read_until(sensor, lambda: sensor.health().lost >= 3)
        await closed(sensor)
        await box.stop()


async def test_can_through_slcan(box: SriBox) -> None:
    path = await box.start_slcan()
    config = SriSensor.Config(
        transport="can",
        can_interface="slcan",
        can_channel=path,
        can_options={"sleep_after_open": 0, "bitrate": 1_000_000},
        rate_hz=200,
    )
    sensor = await opened(SriSensor(config))
    assert sensor.fileno() >= 0
    samples = await some(sensor)
    assert samples[-1][3:9] == pytest.approx(WRENCH, rel=2e-3, abs=0.5)
    await closed(sensor)


@pytest.mark.parametrize(
    ("fault", "value"),
    [("split", 1), ("coalesce", 7), ("ack_in_stream_every", 3), ("header_in_data", 1)],
)
async def test_harmless_oddities_of_the_stream(box: SriBox, fault: str, value: int) -> None:
    sensor = await opened(await tcp_sensor(box))
    box.faults.inject(fault, value)
    await some(sensor, 60)
    assert (sensor.health().lost, sensor.health().checksum_errors) == (0, 0)
    await closed(sensor)


async def test_a_stream_left_running_is_stopped_first(box: SriBox) -> None:
    box.faults.inject("stale_stream")
    sensor = await opened(await tcp_sensor(box))
    await some(sensor)
    assert sensor.health().resynchronised_bytes == 0
    await closed(sensor)


async def test_older_firmware_knows_only_smpr(box: SriBox) -> None:
    box.faults.inject("no_smpf")
    sensor = await opened(await tcp_sensor(box))
    await some(sensor)
    assert box.settings.rate_hz == 500
    await closed(sensor)


async def test_damaged_frames_are_counted_and_are_no_samples(box: SriBox) -> None:
    sensor = await opened(await tcp_sensor(box))
    box.faults.inject("corrupt_every", 5)
    samples = await read_until(sensor, lambda: sensor.health().checksum_errors >= 4)
    for sample in samples:
        assert sample[3:9] == pytest.approx(WRENCH, rel=2e-3, abs=0.5)
    assert sensor.health().lost >= 3
    await closed(sensor)


async def test_skipped_numbers_are_lost_samples(box: SriBox) -> None:
    sensor = await opened(await tcp_sensor(box))
    box.faults.inject("skip_every", 4)
    await read_until(sensor, lambda: sensor.health().lost >= 5)
    assert sensor.health().checksum_errors == 0
    await closed(sensor)


async def test_nan_is_no_sample(box: SriBox) -> None:
    sensor = await opened(await tcp_sensor(box))
    await some(sensor)
    box.faults.inject("nan")
    before = sensor.health()
    samples = await read_until(sensor, lambda: sensor.health().invalid >= 5)
    assert sensor.health().samples - before.samples == len(samples)
    box.faults.clear()
    await some(sensor)
    await closed(sensor)


async def test_a_box_that_does_not_count_its_frames_is_named(box: SriBox) -> None:
    """Each frame would pass for the one before, and the sensor for a silent one."""
    box.faults.inject("uncounted")
    sensor = await opened(await tcp_sensor(box))
    with pytest.raises(SensorSetupWrong, match=r"package number of .* in every frame"):
        await read_until(sensor, lambda: False)
    await closed(sensor)


async def test_frames_that_are_repeated_later_are_no_fault_of_the_setup(box: SriBox) -> None:
    sensor = await opened(await tcp_sensor(box))
    await some(sensor)
    before = sensor.health()
    box.faults.inject("uncounted")
    await read_until(sensor, lambda: sensor.health().invalid >= before.invalid + 100)
    box.faults.clear()
    await some(sensor)
    await closed(sensor)


async def test_saturation_needs_the_range(box: SriBox) -> None:
    sensor = await opened(await tcp_sensor(box, range=(5000.0,) * 3 + (500.0,) * 3))
    box.faults.inject("saturated")
    samples = await read_until(sensor, lambda: sensor.health().saturated >= 3)
    assert samples[-1].saturated
    await closed(sensor)


async def test_a_wrong_rate_is_counted(box: SriBox) -> None:
    sensor = await opened(await tcp_sensor(box))
    box.settings.rate_hz = 250.0
    await read_until(sensor, lambda: sensor.health().rate_deviations >= 1)
    await closed(sensor)


@pytest.mark.parametrize("how", ["dropped", "silent"])
async def test_reading_recovers_by_itself(box: SriBox, how: str) -> None:
    sensor = await opened(
        await tcp_sensor(box, reconnect_s=0.05, first_frame_timeout_s=0.1, reply_timeout_s=0.2)
    )
    if how == "dropped":
        box.drop_clients()
    else:
        box.faults.inject("silent")
        await read_until(sensor, lambda: sensor.fileno() < 0)
        box.faults.clear()
    await read_until(sensor, lambda: sensor.health().reconnects == 1)
    await some(sensor)
    await closed(sensor)


async def test_samples_that_become_late_are_no_samples(box: SriBox) -> None:
    sensor = await opened(await tcp_sensor(box, reconnect_s=0.05, max_lag_s=0.3))
    await some(sensor)
    box.faults.inject("late_s", 0.6)
    await read_until(sensor, lambda: sensor.fileno() < 0)
    # The new stream is late too, which its first frame shows.
    assert await blocking(lambda: sensor.read(2.0)) == ()
    assert sensor.health().reconnects == 0
    box.faults.clear()
    await read_until(sensor, lambda: sensor.health().reconnects == 1)
    await some(sensor)
    await closed(sensor)


async def test_a_box_whose_first_frame_is_late_is_refused(box: SriBox) -> None:
    box.faults.inject("late_s", 0.6)
    sensor = await tcp_sensor(box, max_lag_s=0.3)
    with pytest.raises(StaleData, match=r"0\.[56]\d s late, allowed 0\.3 s"):
        await blocking(sensor.open)
    assert sensor.fileno() == -1


async def test_nobody_listens() -> None:
    (port,) = free_ports(1)
    config = SriSensor.Config(transport="tcp", host="127.0.0.1", port=port)
    with pytest.raises(ConnectTimeout, match=str(port)):
        await blocking(SriSensor(config).open)


async def test_no_such_serial_device() -> None:
    config = SriSensor.Config(transport="serial", device="/dev/no-such-tty", rate_hz=100)
    with pytest.raises(ConnectTimeout, match="no-such-tty"):
        await blocking(SriSensor(config).open)


async def test_no_such_can_interface() -> None:
    config = SriSensor.Config(
        transport="can", can_interface="socketcan", can_channel="no-such-can", rate_hz=100
    )
    with pytest.raises(ConnectTimeout, match="no-such-can"):
        await blocking(SriSensor(config).open)


async def test_a_box_that_does_not_answer(box: SriBox) -> None:
    box.faults.inject("half_open")
    sensor = await tcp_sensor(box, reply_timeout_s=0.1)
    with pytest.raises(ReplyTimeout, match="DCPCU"):
        await blocking(sensor.open)
    assert sensor.fileno() == -1


async def test_a_box_that_answers_but_sends_nothing(box: SriBox) -> None:
    box.faults.inject("silent")
    sensor = await tcp_sensor(box, first_frame_timeout_s=0.2)
    with pytest.raises(ReplyTimeout, match="start of the stream"):
        await blocking(sensor.open)


async def test_a_wrong_matrix_unit_is_refused(box: SriBox) -> None:
    box.settings.raw_unit = "MV"
    with pytest.raises(SensorSetupWrong, match="DCPCU"):
        await blocking((await tcp_sensor(box)).open)


async def test_another_matrix_is_refused(box: SriBox) -> None:
    row = (1.0,) * 6
    with pytest.raises(SensorSetupWrong, match="DCPM"):
        await blocking((await tcp_sensor(box, matrix=(row,) * 6)).open)


async def test_the_box_s_own_matrix_is_accepted(box: SriBox) -> None:
    matrix = tuple(tuple(map(float, row)) for row in box.settings.matrix)
    sensor = await opened(await tcp_sensor(box, matrix=matrix))
    await closed(sensor)


async def test_another_box_after_a_reconnection_is_a_fault(box: SriBox) -> None:
    sensor = await opened(await tcp_sensor(box, reconnect_s=0.05))
    box.settings.raw_unit = "MV"
    box.drop_clients()
    with pytest.raises(SensorSetupWrong):
        await read_until(sensor, lambda: False)
    await closed(sensor)


async def test_reading_a_closed_sensor(box: SriBox) -> None:
    sensor = await tcp_sensor(box)
    with pytest.raises(LinkLost):
        await asyncio.to_thread(sensor.read, 0.01)
