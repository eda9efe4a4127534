"""The places of one plugging by the drawings, and straight or jointed moves between them."""

from collections.abc import Iterator
from functools import cached_property
from pathlib import Path

from scipy.spatial.transform import RigidTransform

from cellctl.config.cell import CellConfig
from cellctl.config.stated.arm_places import ArmPlaces
from cellctl.config.stated.moves import MoveKind, StatedMove, StatedPlace
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.drawings import read_drawings
from cellctl.processes.antenna_module.mated import MATED_TURN, connector_T_plug
from cellctl.processes.antenna_module.moves.places import (
    AWAY_M,
    OVER_SOCKET_M,
    raised,
    shifted,
)
from cellctl.processes.antenna_module.pushing.way import InsertionWay
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.roles import ARM, INSPECT_PLUG, SOCKET_LOOK, TRAY_LOOK


class PluggingPlaces:
    """Tray, camera II and socket of one recipe, as the flange stands there."""

    def __init__(self, cell: CellConfig, recipe: AntennaRecipe, folder: Path) -> None:
        """Reads the drawings beside the cell file; raises ``ConnectorFileInvalid``."""
        self.cell = cell
        self.recipe = recipe
        self.arm = ArmPlaces(cell, recipe.device(ARM))
        self._socket = read_drawings(recipe, folder).socket
        self._base_T_socket = pose_from_xyzabc(recipe.base_T_socket.pose)
        self._flange_T_plug = pose_from_xyzabc(recipe.flange_T_plug)

    def taught(self, pose: str) -> StatedPlace:
        """A taught pose."""
        return self.arm.taught(pose)

    def joint(self, start: StatedPlace, end: StatedPlace) -> StatedMove:
        """A move by joints in free air."""
        return StatedMove(self.arm.robot, MoveKind.JOINT, start, end)

    def linear(self, start: StatedPlace, end: StatedPlace, *, approach: bool = False) -> StatedMove:
        """A straight move."""
        return StatedMove(self.arm.robot, MoveKind.LINEAR, start, end, approach=approach)

    def again(self, look: StatedPlace) -> Iterator[StatedMove]:
        """Up and back, for a second look."""
        over = self.raised(f"over {look.label}", look, AWAY_M)
        yield self.linear(look, over)
        yield self.linear(over, look)

    def climbing(self, start: StatedPlace, end: StatedPlace) -> Iterator[StatedMove]:
        """Straight up to the height of ``end`` where that is higher, then across."""
        climb_m = self._height_m(end) - self._height_m(start)
        if climb_m > 0.0:
            high = self.raised(f"{start.label}, as high as {end.label}", start, climb_m)
            yield self.linear(start, high)
            start = high
        yield self.linear(start, end)

    def raised(self, label: str, place: StatedPlace, height_m: float) -> StatedPlace:
        """Higher along z of the base."""
        return StatedPlace(label, place.joints_rad, raised(self.arm.flange_at(place), height_m))

    def aside(self, place: StatedPlace, x_m: float) -> StatedPlace:
        """Shifted along x of the base."""
        label = f"{x_m / MM:+g} mm beside {place.label}"
        return StatedPlace(label, place.joints_rad, shifted(self.arm.flange_at(place), x_m, 0.0))

    @cached_property
    def grip(self) -> StatedPlace:
        """The fingers round the module on its tray."""
        base_T_plug = pose_from_xyzabc(self.recipe.base_T_tray_plug.pose)
        return self._at("grip", TRAY_LOOK, base_T_plug * self._flange_T_plug.inv())

    @cached_property
    def above_tray(self) -> StatedPlace:
        """The place over the tray from which the tips come down."""
        return self.raised("above the tray", self.grip, self.recipe.grip_approach_mm * MM)

    @cached_property
    def high_over_tray(self) -> StatedPlace:
        """Over the tray, as high as the module was shown to camera II."""
        inspect_m = self._height_m(self.taught(INSPECT_PLUG))
        higher_m = max(0.0, inspect_m - self._height_m(self.above_tray))
        return self.raised("high over the tray", self.above_tray, higher_m)

    @cached_property
    def seat(self) -> StatedPlace:
        """The plug in its socket, all the way."""
        return self._at("seat", SOCKET_LOOK, self._way.seated)

    @cached_property
    def stand_off(self) -> StatedPlace:
        """The tips over the face of the socket."""
        return self.over_face("stand-off", self.recipe.insertion.stand_off_mm * MM)

    @cached_property
    def over_socket(self) -> StatedPlace:
        """Where the plug comes down from."""
        return self.raised("over the socket", self.stand_off, OVER_SOCKET_M)

    @cached_property
    def released(self) -> StatedPlace:
        """Straight up from a module that was let go."""
        return self.raised("released", self.seat, self.recipe.insertion.retreat_mm * MM)

    @cached_property
    def released_look(self) -> StatedPlace:
        """Camera I over the module in its socket, as far away as it was from the socket."""
        base_T_top = (
            self._base_T_socket
            * connector_T_plug(self._socket).inv()
            * pose_from_xyzabc(self.recipe.plug_T_top)
        )
        over_m = float(base_T_top.translation[2] - self._base_T_socket.translation[2])
        return self.raised("released look", self.taught(SOCKET_LOOK), over_m)

    @cached_property
    def clear_of_socket(self) -> StatedPlace:
        """The place from which the way home begins, whatever was done at the socket."""
        face = self._base_T_socket * MATED_TURN * self._flange_T_plug.inv()
        at_face = self._at("face of the socket", SOCKET_LOOK, face)
        return self.raised("clear of the socket", at_face, self.recipe.grip_approach_mm * MM)

    def over_face(self, label: str, height_m: float) -> StatedPlace:
        """The tips so high over the face of the socket, along its axis."""
        return self._at(label, SOCKET_LOOK, self._way.pose_at(-height_m))

    @cached_property
    def _way(self) -> InsertionWay:
        flange_T_plug = self._flange_T_plug * connector_T_plug(self._socket)
        seated = self._base_T_socket * flange_T_plug.inv()
        return InsertionWay.of(seated, flange_T_plug, self._socket.seat_depth_m)

    def _at(self, label: str, near: str, base_T_flange: RigidTransform) -> StatedPlace:
        """A place of the flange, with the arm folded as at a taught pose."""
        return StatedPlace(label, self.taught(near).joints_rad, base_T_flange)

    def _height_m(self, place: StatedPlace) -> float:
        return float(self.arm.flange_at(place).translation[2])
