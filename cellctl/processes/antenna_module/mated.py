"""How plug and socket lie when they are mated: the drawing's part of the chain.

The chain's frame ``plug`` coincides with ``socket`` when the plug is seated as drawn, so that what
is taught, or what goes wrong, is a small pose. Drawings have z out of their own mating face; a plug
therefore meets its socket turned by half a turn about y, with its rows on those of the socket.
"""

from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.processes.antenna_module.connector.connector import Connector

MATED_TURN = RigidTransform.from_rotation(Rotation.from_euler("y", 180, degrees=True))
"""The drawing of a plug in that of its socket where both origins meet."""


def connector_T_plug(socket: Connector) -> RigidTransform:
    """From the drawing of the plug to the chain's frame ``plug``."""
    socket_T_connector = RigidTransform.from_translation([0, 0, -socket.seat_depth_m]) * MATED_TURN
    return socket_T_connector.inv()
