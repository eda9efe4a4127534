"""What is chosen at the pendant: load, tool and work object, asked for and never changed."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.euler_order import EulerOrder
from cellctl.interfaces import ArmLoad, PendantSelection
from drivers.robot.siasun_rpc.codec.messages import Value
from drivers.robot.siasun_rpc.connections.link import RpcLink
from drivers.robot.siasun_rpc.protocol import request
from drivers.robot.siasun_rpc.watch import read_pose

MOST_LOAD_KG = 35.0
"""Greatest load of any arm with this interface (vendor's manual: ``set_load_data``, 0 to 35 kg)."""
_AT_THE_FLANGE_M = 1e-6
_AT_THE_FLANGE_RAD = 1e-6
"""A tool whose frame differs by less has the frame of the flange."""


async def selection(link: RpcLink, euler: EulerOrder) -> PendantSelection:
    """Ask now; what a controller does not know, or answers with another number of figures, is
    None. Raises the faults of the link."""
    load = await link.ask_if_known(request("get_tool_load"))
    tool = _frame(await link.ask_if_known(request("get_tcp_offset")), euler)
    work = _frame(await link.ask_if_known(request("get_wobj")), euler)
    return PendantSelection(_load(load, tool), tool, work)


def _frame(answer: Value, euler: EulerOrder) -> RigidTransform | None:
    return read_pose(answer, euler) if isinstance(answer, list) and len(answer) == 6 else None


def _load(answer: Value, flange_T_tool: RigidTransform | None) -> ArmLoad | None:
    if not (isinstance(answer, list) and len(answer) == 4):
        return None
    mass_kg, *com_m = (float(figure) for figure in answer)
    # The vendor does not say from which frame it counts. Where the tool's is that of the flange
    # there is no other one.
    at_the_flange = (
        flange_T_tool is not None
        and float(np.linalg.norm(flange_T_tool.translation)) < _AT_THE_FLANGE_M
        and float(flange_T_tool.rotation.magnitude()) < _AT_THE_FLANGE_RAD
    )
    return ArmLoad(mass_kg, np.array(com_m) if at_the_flange else None)
