"""What grippers and digital I/O are asked: their signals. No output is switched."""

from collections.abc import Awaitable, Callable, Mapping

from cellctl.cell.driver_object import driver_object
from cellctl.cli.connecting.answer import Answer, spread_ms
from cellctl.clock import now_s
from cellctl.config.devices import DigitalIoConfig, GripperConfig
from cellctl.interfaces import DigitalIo, Gripper
from cellctl.interfaces.device import Device

_QUESTIONS = 5


async def ask_gripper(name: str, config: GripperConfig) -> Answer:
    """Where the jaws stand; raises what the driver raises."""
    gripper: Gripper = driver_object("grippers", name, config)

    async def read() -> dict[str, str]:
        state = await gripper.state()
        jaws = "open" if state.opened else "closed" if state.closed else "between the ends"
        return {"jaws": jaws, "part between them": "yes" if state.part_present else "no"}

    return Answer(f"grippers.{name}", config.driver, await _asked(gripper, read))


async def ask_io(name: str, config: DigitalIoConfig) -> Answer:
    """Which signals are on; raises what the driver raises."""
    io: DigitalIo = driver_object("digital_ios", name, config)

    async def read() -> dict[str, str]:
        state = await io.read()
        return {"inputs on": _on(state.inputs), "outputs on": _on(state.outputs)}

    return Answer(f"digital_ios.{name}", config.driver, await _asked(io, read))


async def _asked(device: Device, read: Callable[[], Awaitable[dict[str, str]]]) -> dict[str, str]:
    try:
        began_s = now_s()
        await device.connect()
        connect_s = now_s() - began_s
        trips_s = []
        for _ in range(_QUESTIONS):
            asked_s = now_s()
            facts = await read()
            trips_s.append(now_s() - asked_s)
    finally:
        await device.let_go()
    return {
        "connected after": f"{connect_s:.2f} s",
        "answers after": spread_ms(trips_s),
        **facts,
    }


def _on(signals: Mapping[str, bool]) -> str:
    return ", ".join(name for name, value in signals.items() if value) or "none"
