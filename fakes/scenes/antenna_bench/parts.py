"""Module and socket as they were made and as they lie: drawn at every load, with injected flaws."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.faults import Fault, FaultBoard
from fakes.scenes.antenna_bench.scenario import BenchScenario
from fakes.scenes.antenna_bench.shifts import SHIFT_FAULTS
from fakes.world.connector.contact_lot import MatingPair, MatingSizes, draw_peaks
from fakes.world.connector.drawing import DRAWINGS, SOCKET_T_MATED_PLUG
from fakes.world.connector.made import connector_as_made
from fakes.world.connector.scene import SceneConnector
from fakes.world.frames import MM, Array, from_written, stream, stream_seed
from fakes.world.scene import SceneHole, ScenePlate
from fakes.world.truth import drawn_spread

FAULTS: Mapping[str, str] = {
    "bent_pin": "pin `contact` of the next modules is bent by `x_mm`, `y_mm`",
    "missing_pin": "pin `contact` of the next modules is missing",
    "blocked_hole": "hole `contact` of the next sockets is blocked",
    "foreign_body": "something lies in the next sockets: plugs seat `early_mm` too early",
    "dirt": "the next connectors carry `specks` specks",
    "upside_down": "the next modules lie on their tops",
    "turned": "the next modules lie half a turn round",
    "empty_tray": "no module comes with the next panels",
    "grip_off": "the module settles in the fingers off its place by `x_mm`, `y_mm`, `yaw_deg`",
    **SHIFT_FAULTS,
}
_TOP_THICKNESS_M = 6e-3
_TRAY_THICKNESS_M = 12e-3
_FLIP = RigidTransform.from_matrix(np.diag([1.0, -1.0, -1.0, 1.0]))
_HALF_TURN = RigidTransform.from_matrix(np.diag([-1.0, -1.0, 1.0, 1.0]))


@dataclass(frozen=True, slots=True)
class BenchParts:
    """What was laid into the cell; connectors are kept at the identity pose."""

    plug: SceneConnector
    socket: SceneConnector
    cell_T_tray_plug: RigidTransform
    """The plug of the module where it lies on its tray."""
    cell_T_socket: RigidTransform
    pair: MatingPair


def draw_parts(scenario: BenchScenario, seed: int, number: int, faults: FaultBoard) -> BenchParts:
    """The ``number``-th module and its socket."""
    name = scenario.module.connector
    rng = stream(seed, "antenna bench", number)
    bent, missing = faults.active("bent_pin"), faults.active("missing_pin")
    blocked, dirt = faults.active("blocked_hole"), faults.active("dirt")
    bends = {}
    if bent is not None:
        bends = {_contact(bent): (bent.number("x_mm", 0.3) * MM, bent.number("y_mm", 0.0) * MM)}
    specks = 0 if dirt is None else int(dirt.number("specks", 4))
    plug = connector_as_made(
        name,
        "pins",
        seed=stream_seed(seed, "plug", number),
        camera_T_connector=RigidTransform.identity(),
        true_position_m=scenario.module.true_position_mm * MM,
        bent_m=bends,
        missing=() if missing is None else (_contact(missing),),
        dirt=specks,
        tip=scenario.module.tip,
        housing_m=(scenario.module.housing_mm[0] * MM, scenario.module.housing_mm[1] * MM),
    )
    socket = connector_as_made(
        name,
        "holes",
        seed=stream_seed(seed, "socket", number),
        camera_T_connector=RigidTransform.identity(),
        true_position_m=scenario.socket.true_position_mm * MM,
        blocked=() if blocked is None else (_contact(blocked),),
        dirt=specks,
        housing_m=(scenario.socket.panel_mm[0] * MM, scenario.socket.panel_mm[1] * MM),
    )
    tray, panel = scenario.tray, scenario.socket
    lies = from_written(tray.cell_T_plug_mm_deg) * drawn_spread(rng, tray.placement)
    if faults.active("turned"):
        lies *= _HALF_TURN
    if faults.active("upside_down"):
        lies *= plug_T_top(scenario)
    return BenchParts(
        plug,
        socket,
        lies,
        from_written(panel.cell_T_socket_mm_deg) * drawn_spread(rng, panel.placement),
        _with_foreign_body(mating_pair(plug, socket, rng), faults.active("foreign_body")),
    )


def mating_pair(
    plug: SceneConnector, socket: SceneConnector, rng: np.random.Generator
) -> MatingPair:
    """Contacts of both in the frame of the socket."""
    tips = np.array([[*pin.centre_m, 0.0] for pin in plug.contacts])
    holes = np.array([hole.centre_m for hole in socket.contacts])
    return MatingPair(
        MatingSizes.of(DRAWINGS[plug.name]),
        np.asarray(SOCKET_T_MATED_PLUG.apply(tips))[:, :2],
        holes,
        draw_peaks(rng, len(holes)),
        np.array([float(pin.present) for pin in plug.contacts]),
        np.array([float(hole.blocked) for hole in socket.contacts]),
    )


def _with_foreign_body(pair: MatingPair, fault: Fault | None) -> MatingPair:
    if fault is None:
        return pair
    early_m = fault.number("early_mm", 0.3) * MM
    return replace(pair, sizes=replace(pair.sizes, seat_m=pair.sizes.seat_m - early_m))


def plug_T_top(scenario: BenchScenario) -> RigidTransform:
    """The module's top in the frame of its plug, z away from the plug."""
    return RigidTransform.from_translation([0.0, 0.0, -scenario.module.height_mm * MM]) * _FLIP


def module_top(
    scenario: BenchScenario, parts: BenchParts, camera_T_plug: RigidTransform
) -> ScenePlate:
    """What a camera above the tray sees of a module: its top with holes."""
    module = scenario.module
    holes = tuple(
        SceneHole(
            f"T{index}", "pin", (x * MM, -y * MM), module.top_hole_diameter_mm * MM, None,
            _TOP_THICKNESS_M, through=False,
        )
        for index, (x, y) in enumerate(module.top_holes_mm, start=1)
    )  # fmt: skip
    width, depth = module.housing_mm
    return ScenePlate(
        "module",
        camera_T_plug * plug_T_top(scenario),
        (width * MM, depth * MM),
        _TOP_THICKNESS_M,
        holes,
        parts.plug.seed,
    )


def tray_face(scenario: BenchScenario, camera_T_cell: RigidTransform, seed: int) -> ScenePlate:
    """The tray under the module, which stands out of it."""
    tray = scenario.tray
    lies = from_written(tray.cell_T_plug_mm_deg) * plug_T_top(scenario)
    down = RigidTransform.from_translation([0.0, 0.0, -tray.below_top_mm * MM])
    return ScenePlate(
        "tray",
        camera_T_cell * lies * down,
        (tray.size_mm[0] * MM, tray.size_mm[1] * MM),
        _TRAY_THICKNESS_M,
        (),
        seed,
        tray.brightness,
    )


def placed(connector: SceneConnector, camera_T_connector: RigidTransform) -> SceneConnector:
    """The same connector before a camera."""
    return replace(connector, camera_T_connector=camera_T_connector)


def offsets_m(pair: MatingPair, socket_T_plug: RigidTransform) -> Array:
    """Offset of each pin from its hole in the plane of the face, shape (n, 2)."""
    nominal_T_plug = socket_T_plug * SOCKET_T_MATED_PLUG.inv()
    tips = np.column_stack([pair.pins_m, np.zeros(len(pair.pins_m))])
    return np.asarray(nominal_T_plug.apply(tips))[:, :2] - pair.holes_m


def placing_offsets_m(pair: MatingPair, socket_T_plug: RigidTransform) -> Array:
    """What the plug as a whole is off at each pin, shape (n, 2): the rigid part of ``offsets_m``.

    The rest is what single pins and holes are off their own places, which nobody can place away.
    """
    x, y = pair.holes_m.T
    # The displacement of a pin by x, y and a small turn, as in ``insertion``: linear, so that one
    # least-squares solution finds all three.
    ones, zeros = np.ones_like(x), np.zeros_like(x)
    design = np.stack(
        [np.column_stack([ones, zeros, -y]), np.column_stack([zeros, ones, x])], axis=1
    ).reshape(-1, 3)
    offsets = offsets_m(pair, socket_T_plug).ravel()
    return np.asarray((design @ np.linalg.lstsq(design, offsets, rcond=None)[0]).reshape(-1, 2))


def _contact(fault: Fault) -> str:
    return fault.text("contact", "1")
