"""What the operator of the antenna cell does: boards, hands at the panel, the next module."""

from collections.abc import Mapping
from typing import Any, Final

from scipy.spatial.transform import RigidTransform

from fakes.scenes.antenna_bench.bench import BenchWorld
from fakes.scenes.antenna_bench.boards import BOARD_PLACES, BoardPlace, board_pose
from fakes.scenes.antenna_bench.hands import HandsAtPanel, seated_by_hand
from fakes.scenes.antenna_bench.mating import KEPT_M
from fakes.scenes.antenna_bench.standing_by import StandingBy
from fakes.world.connector.drawing import SOCKET_T_MATED_PLUG
from fakes.world.frames import MM, distance, stream
from fakes.world.world import Command

_ABOVE_SOCKET_M: Final = 5e-3
"""Height above the seat at which a hand stops and begins to plug."""
_GLANCE_MS: Final = 100
"""Time between two glances of an operator who stands by."""


class BenchOperator:
    """The operator beside the bench, as the control port asks for it."""

    def __init__(self, world: BenchWorld) -> None:
        self._world = world
        self._arm = world.arms[world.scenario.gripper.carried_by]
        self._hands = HandsAtPanel(self._arm)
        self._standing_by = StandingBy(world.scenario.hands.patience_s)
        self._plugged = 0
        self.board_at: BoardPlace | None = None
        self._board_pose = RigidTransform.identity()

    def commands(self) -> Mapping[str, Command]:
        """Commands by their name on the control port."""
        return {
            "place_board": self.place_board,
            "remove_boards": self.remove_boards,
            "plug_by_hand": self.plug_by_hand,
            "stand_by": self.stand_by,
        }

    def advance(self, tick_ms: int) -> None:
        """A millisecond has passed."""
        self._hands.advance(self._world.time_s)
        if self._standing_by.on and tick_ms % _GLANCE_MS == 0:
            self._help()

    def cell_T_board(self, cell_T_flange: RigidTransform) -> RigidTransform | None:
        """Where the calibration board is; None while it is put away."""
        if self.board_at is None:
            return None
        return cell_T_flange * self._board_pose if self.board_at == "flange" else self._board_pose

    def place_board(self, where: str, number: int = 0) -> None:
        """Put the calibration board on its stand or onto the flange; each number is another
        placement. There is one board: it leaves its other place."""
        if where not in BOARD_PLACES:
            raise ValueError(f"the board goes to {' or '.join(BOARD_PLACES)}, not to {where!r}")
        if where == "flange" and self._world.module.place == "gripper":
            raise ValueError("the gripper holds a module where the board would hang")
        self.board_at = "table" if where == "table" else "flange"
        self._board_pose = board_pose(
            self._world.scenario, self._world.seed, self.board_at, int(number)
        )

    def remove_boards(self) -> None:
        """Take the calibration board away."""
        self.board_at = None

    def plug_by_hand(self) -> dict[str, Any]:
        """Jog the arm at its panel until the held plug sits in its socket, free of side forces.

        Answers when the jogging has begun; the key is back on remote when it is over.
        """
        if self._world.module.place != "gripper":
            raise ValueError("the gripper holds no module to plug")
        hands, socket = self._world.scenario.hands, self._world.parts.cell_T_socket
        if self._away_mm() > hands.farthest_mm:
            raise ValueError(
                f"the plug is {self._away_mm():.0f} mm from its socket, by hand it may be "
                f"{hands.farthest_mm:g}"
            )
        rng = stream(self._world.seed, "by hand", self._plugged)
        seated = socket * seated_by_hand(self._world.parts.pair, self._world.mount, hands, rng)
        above = socket * RigidTransform.from_translation([0, 0, _ABOVE_SOCKET_M])
        flange_of = self._world.module.flange_T_plug.inv()
        way = [
            (above * socket.inv() * seated * flange_of, hands.travel_mm_s * MM),
            (seated * flange_of, hands.plugging_mm_s * MM),
        ]
        self._hands.begin(self._world.time_s, way)
        self._plugged += 1
        return {"plugged": self._plugged}

    def stand_by(self, on: bool = True) -> None:  # noqa: FBT001, FBT002  by its name only
        """While a correction is taught: plug by hand whatever waits above the socket, and bring the
        next module and panel when the arm has left a plugged one."""
        self._standing_by.on = on

    def _help(self) -> None:
        arm, place = self._arm, self._world.module.place
        resting = not (arm.by_hand or arm.moving(self._world.time_s))
        near = self._away_mm() < self._world.scenario.hands.farthest_mm
        free = self._world.mating.depth_m < KEPT_M
        errand = self._standing_by.errand(
            self._world.time_s,
            waits_above=place == "gripper" and resting and near and free,
            left_in_socket=place == "socket" and not near,
        )
        if errand == "plug":
            self.plug_by_hand()
        elif errand == "load":
            self._world.load()

    def _away_mm(self) -> float:
        """Distance from the plug's place in the fingers, also empty ones, to the socket's."""
        flange_T_plug = self._world.module.flange_T_plug
        cell_T_plug = self._world.flange(self._world.scenario.gripper.carried_by) * flange_T_plug
        away_m, _ = distance(self._world.parts.cell_T_socket * SOCKET_T_MATED_PLUG, cell_T_plug)
        return away_m / MM
