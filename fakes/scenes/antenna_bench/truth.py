"""What nobody in the antenna cell knows exactly, as the control port tells it."""

from typing import Any

import numpy as np

from fakes.scenes.antenna_bench.bench import BenchWorld
from fakes.scenes.antenna_bench.boards import BoardPlace
from fakes.scenes.antenna_bench.parts import offsets_m, placing_offsets_m
from fakes.world.connector.insertion import PinState
from fakes.world.frames import MM, to_written
from fakes.world.scene import MonoTruth


def truth_of(world: BenchWorld, board_at: BoardPlace | None) -> dict[str, Any]:
    """Poses, the plug against its socket, pins by their state, forces; mm, degrees, N.

    ``board_at`` is where the operator has put the calibration board; None: it is put away.
    """
    return {**_devices(world), "board": board_at, **_plug(world)}


def _devices(world: BenchWorld) -> dict[str, Any]:
    flange = world.flange(world.scenario.gripper.carried_by)
    cell_T_base = world.truth.robots[world.scenario.gripper.carried_by].cell_T_base
    camera_1, camera_2 = world.scenario.carried_camera, world.scenario.fixed_camera
    optics = {name: truth.optics for name, truth in world.truth.cameras.items()}
    return {
        "cell_T_flange_mm_deg": to_written(flange),
        "cell_T_camera_mm_deg": {
            name: to_written(world.camera_pose(name)) for name in world.truth.cameras
        },
        "flange_T_cam1_mm_deg": to_written(flange.inv() * world.camera_pose(camera_1)),
        "base_T_cam2_mm_deg": to_written(cell_T_base.inv() * world.camera_pose(camera_2)),
        "intrinsics": {
            name: _intrinsics(one) for name, one in optics.items() if isinstance(one, MonoTruth)
        },
        "flange_T_marks_mm_deg": to_written(world.flange_T_marks),
        "cell_T_plate_mm_deg": to_written(world.cell_T_plate),
    }


def _intrinsics(optics: MonoTruth) -> dict[str, Any]:
    lens = optics.lens
    return {
        "image_px": list(optics.image_size_px),
        "focal_px": list(lens.focal_px),
        "centre_px": list(lens.centre_px),
        "distortion": list(lens.distortion),
    }


def _plug(world: BenchWorld) -> dict[str, Any]:
    flange = world.flange(world.scenario.gripper.carried_by)
    parts, mating = world.parts, world.mating
    cell_T_plug = world.module.now(flange)
    rests_at = parts.cell_T_socket.inv() * world.rests_at(flange)
    names = [contact.name for contact in parts.plug.contacts]
    offsets = np.linalg.norm(offsets_m(parts.pair, parts.cell_T_socket.inv() * cell_T_plug), axis=1)
    met = None if mating.met_at is None else placing_offsets_m(parts.pair, mating.met_at)
    return {
        "load": world.loads,
        "module": world.module.place,
        "cell_T_socket_mm_deg": to_written(parts.cell_T_socket),
        "cell_T_plug_mm_deg": to_written(cell_T_plug),
        "socket_T_plug_mm_deg": to_written(rests_at),
        "offset_at_worst_contact_mm": float(offsets.max() / MM),
        "worst_contact": names[int(offsets.argmax())],
        "met_offset_at_worst_contact_mm": (
            None if met is None else float(np.linalg.norm(met, axis=1).max() / MM)
        ),
        "seated_depth_mm": -float(rests_at.translation[2] / MM),
        "seat_depth_mm": parts.pair.sizes.seat_m / MM,
        "pins": {
            name: PinState(state).name.lower()
            for name, state in zip(names, mating.states, strict=True)
        },
        "bent": [pin.name for pin in parts.plug.contacts if any(pin.bend_m)],
        "missing": [pin.name for pin in parts.plug.contacts if not pin.present],
        "blocked": [hole.name for hole in parts.socket.contacts if hole.blocked],
        "peak_side_n": dict(zip(names, mating.peak_side_n.tolist(), strict=True)),
        "peak_axial_n": dict(zip(names, mating.peak_axial_n.tolist(), strict=True)),
        "peak_total_n": mating.peak_total_n,
    }
