"""Grippers and digital I/O are asked over the wire; an output that somebody has on stays on."""

from cellctl.cli.connecting.outputs import ask_gripper, ask_io
from cellctl.clock import now_s
from cellctl.config.devices import DigitalIoConfig, GripperConfig
from drivers.io.modbus_coupler.config import ModbusCouplerConfig
from drivers.io.modbus_coupler.driver import ModbusCouplerIo
from fakes.wire.couplers.coupler import CouplerServer
from tests.wire.modbus.gripper_rig import gripper_rig


async def test_outputs_of_another_program_stay_as_they_are() -> None:
    coupler = CouplerServer(
        now_s, inputs=lambda _: {0: True, 1: False}, output_addresses=range(2), watchdog_ms=900
    )
    settings = {
        "host": "127.0.0.1",
        "port": await coupler.start(),
        "inputs": {"door": 0, "tray": 1},
        "outputs": {"lamp": 0, "clamp": 1},
    }
    other = ModbusCouplerIo("other", ModbusCouplerConfig.model_validate(settings))
    try:
        async with other:
            await other.write({"lamp": True})
            answer = await ask_io("io", DigitalIoConfig(driver="modbus-coupler", settings=settings))
            assert (answer.path, answer.good) == ("digital_ios.io", True)
            assert answer.facts["inputs on"] == "door"
            assert answer.facts["outputs on"] == "lamp"
            assert "p50" in answer.facts["answers after"]
            # The other program sees it, and the coupler was told nothing more.
            assert (await other.read()).outputs == {"lamp": True, "clamp": False}
            assert coupler.writes == 1
    finally:
        await coupler.stop()


async def test_a_gripper_says_where_its_jaws_stand_and_does_not_move() -> None:
    async with gripper_rig() as rig:
        settings = rig.settings.model_dump()
        config = GripperConfig(driver="pneumatic-modbus", settings=settings)
        answer = await ask_gripper("gripper", config)
        assert answer.facts["jaws"] == "open"
        assert rig.coupler.writes == 0
