"""What is chosen at the pendant of a collaborative arm is read back, and never changed."""

import asyncio

import numpy as np
import pytest
from thrift.protocol.TBinaryProtocol import TBinaryProtocol
from thrift.Thrift import TMessageType, TType
from thrift.transport.TTransport import TMemoryBuffer

from cellctl.cell.robot_reports import listen
from fakes.wire.duco.tasks import TaskEnd
from tests.rigs.wire.duco_rig import DucoRig, duco_rig

LOAD = [4.2, 0.0, 0.01, 0.06]


async def test_load_tool_and_work_object() -> None:
    async with duco_rig() as rig:
        rig.logic.tool_load = LOAD
        rig.logic.work_object = [1.0, 0.0, 0.0, 0.0, 0.0, np.pi / 2]
        await rig.robot.connect()
        found = await rig.robot.selection()
        assert found.load is not None
        assert found.load.mass_kg == 4.2
        assert found.load.flange_r_com_m == pytest.approx(LOAD[1:])
        assert found.flange_T_tool is not None
        assert found.base_T_work is not None
        assert found.base_T_work.apply([0.0, 1.0, 0.0]) == pytest.approx([0.0, 0.0, 0.0])


async def test_people_read_it_in_millimetres() -> None:
    async with duco_rig() as rig:
        rig.logic.tool_load, rig.logic.tool_frame = LOAD, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        await rig.robot.connect()
        shown = (await listen(rig.robot, 0.05)).as_json()["selected_at_the_pendant"]
        assert (shown["load_kg"], shown["load_com_mm"]) == (4.2, [0.0, 10.0, 60.0])
        assert shown["flange_T_tool_xyzabc_mm_deg"] == [0.0] * 6


async def test_beside_another_tool_the_centre_of_mass_is_not_believed() -> None:
    """Nobody says whether the controller counts from the flange or from the tool."""
    async with duco_rig() as rig:
        rig.logic.tool_load, rig.logic.tool_frame = LOAD, [0.0, 0.0, 0.1, 0.0, 0.0, 0.0]
        await rig.robot.connect()
        found = await rig.robot.selection()
        assert found.load is not None
        assert (found.load.mass_kg, found.load.flange_r_com_m) == (4.2, None)


@pytest.mark.parametrize("call", ["get_tool_load", "get_tcp_offset", "get_wobj"])
async def test_a_controller_that_does_not_know_the_question_goes_on(call: str) -> None:
    async with duco_rig() as rig:
        rig.logic.faults.inject("unknown", call=call)
        await rig.robot.connect()
        found = await rig.robot.selection()
        assert (found.load is None) is (call == "get_tool_load")
        assert (found.flange_T_tool is None) is (call == "get_tcp_offset")
        assert (found.base_T_work is None) is (call == "get_wobj")
        assert rig.robot.state().drives_on


async def set_load(rig: DucoRig, load: list[float]) -> int:
    """State of the task that a client's own `set_load_data` ends with."""
    call = TMemoryBuffer()
    protocol = TBinaryProtocol(call, strictWrite=True)
    protocol.writeMessageBegin("set_load_data", TMessageType.CALL, 0)
    protocol.writeFieldBegin("value", TType.LIST, 1)
    protocol.writeListBegin(TType.DOUBLE, len(load))
    for figure in load:
        protocol.writeDouble(figure)
    protocol.writeFieldStop()
    reader, writer = await asyncio.open_connection("127.0.0.1", rig.controller.rpc_port)
    try:
        writer.write(call.getvalue())
        reply = TBinaryProtocol(TMemoryBuffer(await reader.read(256)), strictRead=True)
        reply.readMessageBegin()
        reply.readFieldBegin()
        return rig.logic.tasks.state(reply.readI32())
    finally:
        writer.close()


async def test_the_controller_refuses_more_than_35_kg() -> None:
    async with duco_rig() as rig:
        assert await set_load(rig, [35.0, 0.0, 0.0, 0.1]) == TaskEnd.FINISHED
        assert await set_load(rig, [35.1, 0.0, 0.0, 0.1]) == TaskEnd.PARAMETERS
        assert rig.logic.tool_load[0] == 35.0
        await rig.robot.connect()
        found = await rig.robot.selection()
        assert found.load is not None
        assert found.load.mass_kg == 35.0
