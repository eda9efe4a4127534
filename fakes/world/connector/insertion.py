"""A plug on springs that goes into its socket: forces in closed form.

Every pin is outside, inside, standing on the face, or collapsed; which of them is decided when its
tip reaches the face. Pins inside are pressed by the walls of funnel and bore; the plug gives way to
them in x, y and in its turn about the axis, as its mount lets it (three unknowns, Newton). Along
the axis there are wall forces, contact springs, standing pins and the seat. Depth counts from where
pins reach the face, along the axis of the socket.

Not modelled: the round tip that rolls over the end of the funnel (the peak there is too high, on
the safe side), friction of standing pins across the face, tilt that the mount gives way in.
"""

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Final

import numpy as np
from numpy.typing import NDArray

from fakes.world.connector.contact_lot import MatingPair, Mount
from fakes.world.frames import Array

_NEWTON_STEPS: Final = 40
_TOLERANCE_N: Final = 1e-7
_BISECTIONS: Final = 40
"""Halvings of a millimetre, which leave less than 1e-15 m."""


class PinState(IntEnum):
    """What became of a pin."""

    OUTSIDE = 0
    INSIDE = 1
    STANDING = 2
    COLLAPSED = 3


States = NDArray[np.int8]


@dataclass(frozen=True, slots=True)
class PlugPlace:
    """Where the mount would hold the free plug, against its nominal place in the socket."""

    x_m: float = 0.0
    y_m: float = 0.0
    yaw_rad: float = 0.0
    tilt_rad: tuple[float, float] = (0.0, 0.0)
    """Tilt about x and about y."""
    depth_m: float = 0.0
    inwards: bool = True
    """Contact springs rub against the motion."""


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """Forces on the plug at one depth, in the axes of the socket about its origin."""

    states: States
    wrench: Array
    """N and N·m, shape (6,); z pushes the plug out."""
    deflection: Array
    """How far the mount gives way: x, y (m), turn (rad)."""
    side_n: Array
    """Wall force of each pin, shape (n,)."""
    axial_n: Array
    """Axial force of each pin without its contact spring, shape (n,)."""


def outside(pair: MatingPair) -> States:
    """The states before anything touches."""
    return np.full(len(pair.pins_m), PinState.OUTSIDE, dtype=np.int8)


def respond(pair: MatingPair, mount: Mount, states: States, place: PlugPlace) -> Response:
    """Forces with the plug itself at the depth of ``place``; ``states`` are those before."""
    free = _offsets(pair, place)
    depths = _depths(pair, place)
    after = _entered(pair, states, free, depths)
    inside = (after == PinState.INSIDE) & (pair.present > 0)
    plays = pair.sizes.play(depths)
    deflection = _equilibrium(pair, mount, free, plays, inside)
    d = free + _moved(pair, deflection)
    walls = _wall_forces(pair, d, plays, inside)
    side = np.linalg.norm(walls, axis=1)
    in_funnel = depths < pair.sizes.funnel_m
    direction = 1.0 if place.inwards else -1.0
    rub = np.where(in_funnel & place.inwards, pair.sizes.funnel_slope, pair.sizes.friction)
    standing = np.where(after == PinState.STANDING, pair.sizes.face_n_m * depths, 0.0)
    collapsed = standing > pair.sizes.collapse_n
    after[collapsed] = PinState.COLLAPSED
    axial = direction * rub * side + np.where(collapsed, 0.0, np.maximum(standing, 0.0))
    springs = direction * inside * _spring_forces(pair, depths)
    total = axial + springs
    seat = pair.sizes.seat_n_m * max(place.depth_m - pair.sizes.seat_m, 0.0)
    x, y = pair.pins_m.T
    wrench = np.array(
        [
            walls[:, 0].sum(),
            walls[:, 1].sum(),
            total.sum() + seat,
            (y * total).sum(),
            -(x * total).sum(),
            (x * walls[:, 1] - y * walls[:, 0]).sum(),
        ]
    )
    return Response(after, wrench, deflection, side, axial)


def pressed(
    pair: MatingPair, mount: Mount, states: States, place: PlugPlace
) -> tuple[float, Response]:
    """True depth (m) and forces when the far end of the axial spring is at the depth of ``place``.

    The spring is stiffer than any contact spring gives way, so there is one depth; beyond a pin
    that collapses the depth is found again.
    """
    low, high = place.depth_m - 1e-3, place.depth_m
    if respond(pair, mount, states, place).wrench[2] < 0:
        # On the way out contact springs pull the plug back into the socket.
        low, high = place.depth_m, place.depth_m + 1e-3
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        force_n = respond(pair, mount, states, replace(place, depth_m=middle)).wrench[2]
        if force_n > mount.axial_n_m * (place.depth_m - middle):
            high = middle
        else:
            low = middle
    depth_m = (low + high) / 2
    return depth_m, respond(pair, mount, states, replace(place, depth_m=depth_m))


def _offsets(pair: MatingPair, place: PlugPlace) -> Array:
    """Offset of each pin from the middle of its hole in a stiff mount, shape (n, 2)."""
    move = np.array([place.x_m, place.y_m, place.yaw_rad])
    return np.asarray(pair.pins_m - pair.holes_m + _moved(pair, move))


def _moved(pair: MatingPair, move: Array) -> Array:
    """Displacement of each pin by x, y and a small turn."""
    x, y = pair.pins_m.T
    return np.column_stack([move[0] - move[2] * y, move[1] + move[2] * x])


def _depths(pair: MatingPair, place: PlugPlace) -> Array:
    x, y = pair.pins_m.T
    about_x, about_y = place.tilt_rad
    return np.asarray(place.depth_m - about_x * y + about_y * x)


def _entered(pair: MatingPair, states: States, free: Array, depths: Array) -> States:
    after = states.copy()
    reached = (states == PinState.OUTSIDE) & (depths > 0) & (pair.present > 0)
    # All the pins decide by themselves: until the first of them is inside, nothing guides the plug.
    caught = (np.linalg.norm(free, axis=1) <= pair.sizes.capture_m) & (pair.blocked < 1)
    after[reached & caught] = PinState.INSIDE
    after[reached & ~caught] = PinState.STANDING
    withdrawn = (depths <= 0) & (states != PinState.COLLAPSED)
    after[withdrawn] = PinState.OUTSIDE
    return after


def _equilibrium(
    pair: MatingPair, mount: Mount, free: Array, plays: Array, inside: NDArray[np.bool_]
) -> Array:
    """Deflection in which the mount carries the wall forces."""
    stiffness = np.diag(mount.stiffness)
    x, y = pair.pins_m.T
    zero, one = np.zeros_like(x), np.ones_like(x)
    jacobian = np.stack([np.stack([one, zero, -y], 1), np.stack([zero, one, x], 1)], 1)
    u = np.zeros(3)
    for _ in range(_NEWTON_STEPS):
        d = free + _moved(pair, u)
        forces = _wall_forces(pair, d, plays, inside)
        residual = stiffness @ u - np.einsum("nij,ni->j", jacobian, forces)
        if np.abs(residual).max() < _TOLERANCE_N:
            return u
        hessian = np.einsum(
            "nij,nik,nkl->jl", jacobian, _wall_stiffness(pair, d, plays, inside), jacobian
        )
        u = u - np.linalg.solve(stiffness + hessian, residual)
    return u


def _wall_forces(pair: MatingPair, d: Array, plays: Array, inside: NDArray[np.bool_]) -> Array:
    length = np.maximum(np.linalg.norm(d, axis=1), 1e-12)
    pressed_in = np.where(inside, np.maximum(length - plays, 0.0), 0.0)
    return np.asarray(-(pair.sizes.wall_n_m * pressed_in / length)[:, None] * d)


def _wall_stiffness(pair: MatingPair, d: Array, plays: Array, inside: NDArray[np.bool_]) -> Array:
    """Derivative of the wall forces against the offsets, shape (n, 2, 2), positive."""
    length = np.maximum(np.linalg.norm(d, axis=1), 1e-12)
    touching = inside & (length > plays)
    share = np.where(touching, plays / length, 0.0)
    unit = d / length[:, None]
    along = unit[:, :, None] * unit[:, None, :]
    across = np.eye(2) * (touching - share)[:, None, None] + share[:, None, None] * along
    return np.asarray(pair.sizes.wall_n_m * across)


def _spring_forces(pair: MatingPair, depths: Array) -> Array:
    """Rises to its peak, falls to what sliding needs over the same way."""
    sizes = pair.sizes
    way = (depths - sizes.spring_begin_m) / sizes.spring_rise_m
    falling = 1 - (1 - sizes.sliding_share) * np.clip(way - 1, 0.0, 1.0)
    return np.asarray(pair.peaks_n * np.clip(way, 0.0, 1.0) * falling)
