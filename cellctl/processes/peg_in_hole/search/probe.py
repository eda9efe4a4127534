"""What all strategies do: touch, slide, look for the way in, and keep what was felt."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from cellctl.cell.contact_motion.motions import ContactMotion, ContactMotions, ContactSample, Ended
from cellctl.force.contact.spirals import expanding_turns
from cellctl.processes.peg_in_hole.faults import SearchGaveUp
from cellctl.processes.peg_in_hole.first_contact.classify import ContactClass, class_by_force
from cellctl.processes.peg_in_hole.plan.parameters import STANDS_M, SearchParameters
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from cellctl.processes.peg_in_hole.search.conditions import (
    LostSupport,
    Stands,
    Stop,
    against_a_wall,
    depth_m,
    either,
    held,
)
from cellctl.processes.peg_in_hole.search.hole_map import HoleMap

Array = NDArray[np.float64]

UPRIGHT = np.zeros(3)
_LIFT_M = 0.3e-3
"""Lift between two touches (section 1 of the study of insertion by touch)."""
_FREE_M_S = 20e-3
"""Greatest speed through free air; the motion itself goes slower where it might meet something."""
_DIP_M = 0.1e-3
"""An upright peg that is deeper than this below the face does not stand on the face."""
_LET_GO = 3
"""How often a peg that goes deeper each time is let go."""
TOUCH_SHARE = 0.5
"""Share of the press at which a touch ends. Until the arm has answered the force may grow by a
whole press, and stays within the one and a half presses that a search may make."""
_LOCAL_RADIUS_M = 0.25e-3
"""Radius of the spiral round a place that a strategy has found (section 3.4)."""


class Met(StrEnum):
    """What has ended a press."""

    NOTHING = "nothing"
    """The peg has entered."""
    STAND = "stand"
    WALL = "wall"


class Felt(StrEnum):
    """What a point of the search path was."""

    FACE = "face"
    DIP = "dip"
    EDGE = "edge"
    """Edge of the outer face, of a valley, or of the hole: the peg stands below the face."""
    WALL = "wall"
    ENTRY = "entry"


@dataclass(frozen=True, slots=True)
class FeltPoint:
    """One point of the search, for map and report; frame A, m."""

    time_s: float
    x_m: float
    y_m: float
    depth_m: float
    felt: Felt


@dataclass(slots=True)
class SearchTrace:
    """What one search has felt, in order."""

    points: list[FeltPoint] = field(default_factory=list)

    def note(self, sample: ContactSample, felt: Felt) -> None:
        """Keep the end of a motion."""
        x_m, y_m, depth_m = (float(value) for value in sample.task_position_tip_m)
        self.points.append(FeltPoint(sample.time_s, x_m, y_m, depth_m, felt))


class TouchProbe:
    """One search of one hole: motions, task, map and the time that is left."""

    def __init__(
        self,
        motions: ContactMotions,
        task: SearchTask,
        parameters: SearchParameters,
        hole_map: HoleMap,
        deadline_s: float,
        *,
        trace: SearchTrace | None = None,
    ) -> None:
        """``deadline_s``: on the clock of the samples. ``trace``: where the caller keeps one."""
        self.motions = motions
        self.task = task
        self.parameters = parameters
        self.hole_map = hole_map
        self.deadline_s = deadline_s
        self.trace = SearchTrace() if trace is None else trace
        self._lean_m = 0.0
        """How far the low side of a leaning peg is below its tip, m."""
        self.walled = against_a_wall(self.press_n, task.cell)
        """Ends a slide or a press at a flank, before the force on it adds up."""

    @property
    def press_n(self) -> float:
        """Force along z while sliding."""
        return self.parameters.press_n.value

    async def touch_down(self, xy_m: Array, rotation: Array, at_m: float = 0.0) -> ContactSample:
        """Lift, go over a point and touch down there, where a contact is expected ``at_m`` deep.

        Without a contact it ends where a tilted peg would have touched within the hole: an upright
        one then stands over the hole, which the next press tells. Raises ``SearchGaveUp``.
        """
        # The low side of a peg that leans may stand in the hole while its tip is above the face.
        lean_m = self.task.fit.peg_radius_m * float(np.sin(np.linalg.norm(rotation)))
        clear_m = max(self._lean_m, lean_m, -at_m) + _LIFT_M
        await self.motions.back_out(clear_m)
        over = np.array([*xy_m, at_m - _LIFT_M])
        await self.motions.move_free(over, rotation, _FREE_M_S)
        self._lean_m = lean_m
        # A tilted peg tells the hole by how deep it dips; a fifth beyond the deepest dip there is
        # nothing left to wait for.
        deeper_m = 1.2 * self.parameters.tilted_dip.value if np.any(rotation) else _LIFT_M
        down = np.array([0.0, 0.0, 1.0])
        touched = await self.motions.touch(
            down,
            _LIFT_M + deeper_m,
            TOUCH_SHARE * self.press_n,
            self.parameters.touch_speed.value,
        )
        self.still_in_time(touched.last)
        return touched.last

    async def slide(
        self, way_m: Array, speed_m_s: float, until: Stop, *, share: float = 1.0
    ) -> ContactMotion:
        """Slide along a way (n, 2), pressed with ``share`` of the search's force.

        A side force of the same share ends it, and so does the deadline.
        """
        motion = await self.motions.slide(
            way_m,
            share * self.press_n,
            speed_m_s,
            # Asked in the motion itself: one slide may take longer than the time that is left.
            either(until, self._late),
            share * self.task.limits.search_n,
        )
        self.still_in_time(motion.last)
        return motion

    async def enters(self) -> bool:
        """Press; True when the peg stays below the depth of entry."""
        last, met = await self._sinks()
        for _ in range(_LET_GO):
            if met is Met.NOTHING or not self._on_edge(last, met):
                break
            reached_m = depth_m(last)
            # On a chamfer a stiff arm holds the peg where it stands; let go, it slides in. That
            # nothing carries it then is what is hoped for.
            await self.let_go(LostSupport(self.press_n))
            last, met = await self._sinks()
            # On a chamfer it slides in further each time; on a scratch it does not.
            if met is not Met.NOTHING and depth_m(last) - reached_m < STANDS_M:
                break
        entered = met is Met.NOTHING
        stands = Felt.EDGE if self._on_edge(last, met) else Felt.FACE
        self.trace.note(last, Felt.ENTRY if entered else stands)
        self.still_in_time(last)
        return entered

    def _on_edge(self, sample: ContactSample, met: Met) -> bool:
        """Judged by its depth, or by a force that no face makes: the height of a face is not that
        sure."""
        across = class_by_force(sample.force_n, self.task.cell) is not ContactClass.END_FACE
        return met is Met.WALL or depth_m(sample) > _DIP_M or across

    async def _sinks(self) -> tuple[ContactSample, Met]:
        """Press until the peg is in, or something carries it or holds it from the side."""
        entered = held(self.task.fit.entry_depth_m)
        stands = Stands(self.press_n, self.parameters.stand_time.value)
        met = Met.STAND

        def condition(sample: ContactSample) -> bool:
            nonlocal met
            if entered(sample):
                met = Met.NOTHING
            elif self.walled(sample):
                met = Met.WALL
            return met is not Met.STAND or stands(sample) or self._late(sample)

        hold_s = self.parameters.entry_time.value
        pressed = await self.motions.press(self.press_n, hold_s, condition)
        return pressed.last, met

    async def let_go(self, until: Stop) -> ContactSample:
        """Press on, and let the peg go to where nothing pushes it sideways."""
        hold_s = self.parameters.give_way_time.value
        ends = either(until, self._late)
        return (await self.motions.comply(self.press_n, hold_s, ends, turns=False)).last

    async def look_round(self, centre_m: Array, radius_m: float = _LOCAL_RADIUS_M) -> bool:
        """Touch down upright and search a small spiral; True when the peg has entered."""
        await self.touch_down(centre_m, UPRIGHT)
        if await self.enters():
            return True
        return await self.spiral(centre_m, radius_m)

    async def spiral(self, centre_m: Array, radius_m: float) -> bool:
        """Expanding spiral of an upright peg that stands on the face; True when it has entered."""
        parameters = self.parameters
        share = parameters.spiral_press.value / self.press_n
        for way_m, speed_m_s in expanding_turns(
            radius_m, parameters.pitch.value, parameters.slide_speed.value
        ):
            rest_m = way_m + centre_m
            while len(rest_m):
                lost = LostSupport(parameters.spiral_press.value)
                until = either(lost, self.walled)
                motion = await self.slide(rest_m, speed_m_s, until, share=share)
                if motion.ended is Ended.TRAVEL:
                    break
                if await self._enters_between(lost.begin, motion.last):
                    return True
                # It was a scratch or an edge: the turn goes on behind it and does not begin anew.
                rest_m = _beyond(rest_m, motion.last.task_position_tip_m[:2])
                rest_m = await self._out_of_mouth(rest_m)
            # A turn without an entry is knowledge too: a strategy that follows finds it in the map.
            self.hole_map.rule_out(way_m + centre_m)
        return False

    async def _out_of_mouth(self, rest_m: Array) -> Array:
        """The rest of a way (n, 2), from where it leaves a mouth that has let nothing in.

        Slid on from there the peg would only be pressed against the flanks of the same mouth.
        """
        stands = self.trace.points[-1]
        if stands.felt is not Felt.EDGE:
            return rest_m
        away_m = np.linalg.norm(rest_m - [stands.x_m, stands.y_m], axis=1)
        outside_m: Array = rest_m[away_m > self.parameters.catch.value]
        if len(outside_m):
            await self.touch_down(outside_m[0], UPRIGHT)
        return outside_m

    async def _enters_between(self, begin: ContactSample | None, end: ContactSample) -> bool:
        """Back to the middle of where nothing carried the peg, and press there."""
        here_m = end.task_position_tip_m[:2]
        if begin is not None:
            # The peg has crossed the hole along a chord, and no point of a chord is nearer to the
            # centre than its middle.
            middle_m = (begin.task_position_tip_m[:2] + here_m) / 2
            speed = self.parameters.touch_speed.value
            await self.motions.slide(
                middle_m[None, :], self.press_n, speed, self.walled, self.task.limits.search_n
            )
        return await self.enters()

    def still_in_time(self, sample: ContactSample) -> None:
        """Raises ``SearchGaveUp`` past the deadline."""
        if self._late(sample):
            raise SearchGaveUp(f"within {self.task.search_limit_s:.0f} s")

    def _late(self, sample: ContactSample) -> bool:
        return sample.time_s > self.deadline_s


def _beyond(way_m: Array, here_m: Array) -> Array:
    """The part of a way that lies after its point next to here."""
    nearest = int(np.argmin(np.linalg.norm(way_m - here_m, axis=1)))
    return way_m[nearest + 1 :]
