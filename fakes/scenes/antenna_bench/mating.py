"""The plug at its socket, step by step: what became of the pins, how deep it is, what it feels."""

from dataclasses import replace
from typing import Final

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.world.connector.contact_lot import MatingPair, Mount
from fakes.world.connector.drawing import SOCKET_T_MATED_PLUG
from fakes.world.connector.insertion import PinState, PlugPlace, Response, outside, respond
from fakes.world.frames import Array

EVERY_MS: Final = 4
"""Milliseconds between two evaluations: forces change over hundredths of a second."""
KEPT_M: Final = 1.5e-3
"""Depth from which the socket keeps a plug that is let go."""
_MATED_PLUG_T_SOCKET: Final = SOCKET_T_MATED_PLUG.inv().as_matrix()
_NEAR_M: Final = 4e-3
"""Farther aside than this, the plug is not over its socket."""
_ABOVE_M: Final = 0.1e-3
"""Higher than this over the socket, nothing can touch."""
_RELAXATION: Final = 0.15
"""Part of the way to equilibrium along the axis in each evaluation; fifteen standing pins are five
times as stiff as the arm, and more would swing."""
_STILL_M: Final = 1e-8
"""A shorter way between two evaluations does not turn the friction of the contact springs round."""


class PlugAtSocket:
    """One plug and one socket, from the first approach on."""

    def __init__(self, pair: MatingPair, mount: Mount) -> None:
        self.pair, self._mount = pair, mount
        self.states = outside(pair)
        self.response: Response | None = None
        """Response of the last evaluation; None while nothing can touch."""
        self.depth_m = -np.inf
        """True depth of the plug; minus infinity away from the socket."""
        self.peak_side_n = np.zeros(len(self.states))
        self.peak_axial_n = np.zeros(len(self.states))
        self.peak_total_n = 0.0
        """Highest force against the insertion."""
        self._met_at: Array | None = None
        """Place of contact in the last approach; None before the first."""
        self._commanded_m = -np.inf
        self._inwards = True

    @property
    def met_at(self) -> RigidTransform | None:
        """socket_T_plug of the last approach, just before the plug touched: it hangs freely there,
        so this is what the placing was wrong by. None before the first approach."""
        return None if self._met_at is None else RigidTransform.from_matrix(self._met_at)

    def hold_at(self, socket_T_plug: Array) -> Array:
        """The mount holds the free plug there; returns the wrench on the plug in socket axes.

        ``socket_T_plug`` is a matrix, because this is done hundreds of times a second.
        """
        free = socket_T_plug @ _MATED_PLUG_T_SOCKET
        x, y, z = free[:3, 3].tolist()
        turn = Rotation.from_matrix(free[:3, :3]).as_rotvec()
        beside = max(abs(x), abs(y)) > _NEAR_M or -z < -_ABOVE_M
        if beside:
            self.depth_m = self._commanded_m = -np.inf
            # Away from the socket every pin is outside again, except one that has collapsed.
            self.states[self.states < PinState.COLLAPSED] = PinState.OUTSIDE
            self.response = None
            return np.zeros(6)
        self._follow(-z)
        if self._inwards and -z < 0:
            self._met_at = socket_T_plug
        place = PlugPlace(
            x, y, float(turn[2]), (float(turn[0]), float(turn[1])), self.depth_m, self._inwards
        )
        response = respond(self.pair, self._mount, self.states, place)
        self._relax(response)
        self.states, self.response = response.states, response
        self.peak_side_n = np.maximum(self.peak_side_n, response.side_n)
        self.peak_axial_n = np.maximum(self.peak_axial_n, response.axial_n)
        self.peak_total_n = max(self.peak_total_n, float(response.wrench[2]))
        return response.wrench

    def rests_at(self, socket_T_plug: RigidTransform) -> RigidTransform:
        """True pose of the plug: where the mount holds it, less what that gives way."""
        if self.response is None:
            return socket_T_plug
        x, y, yaw = self.response.deflection
        back = RigidTransform.from_components(
            [x, y, self._commanded_m - self.depth_m],
            RigidTransform.from_exp_coords([0, 0, yaw, 0, 0, 0]).rotation,
        )
        return back * socket_T_plug

    def _follow(self, commanded_m: float) -> None:
        if not np.isfinite(self._commanded_m):
            self.depth_m = self._commanded_m = commanded_m
        step_m = commanded_m - self._commanded_m
        if abs(step_m) > _STILL_M:
            self._inwards = step_m > 0
        self.depth_m += step_m
        self._commanded_m = commanded_m

    def _relax(self, response: Response) -> None:
        """Towards the depth at which the axial spring carries the force."""
        wanted_m = self._commanded_m - response.wrench[2] / self._mount.axial_n_m
        self.depth_m += _RELAXATION * (wanted_m - self.depth_m)


def mount_of(lateral_n_mm: float, axial_n_mm: float) -> Mount:
    """Springs from their written units."""
    return replace(Mount(), lateral_n_m=lateral_n_mm * 1e3, axial_n_m=axial_n_mm * 1e3)
