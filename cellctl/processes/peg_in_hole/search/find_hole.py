"""Runs the chosen strategies one after another, and says why none of them found a hole."""

from collections.abc import Mapping

from cellctl.processes.peg_in_hole.faults import HoleAbsent
from cellctl.processes.peg_in_hole.first_contact.classify import ContactClass
from cellctl.processes.peg_in_hole.plan.choice import SearchName
from cellctl.processes.peg_in_hole.search.arc import ArcSearch
from cellctl.processes.peg_in_hole.search.particle_map import ParticleMap
from cellctl.processes.peg_in_hole.search.patent import PatentCircumcentre, PatentMidpoint
from cellctl.processes.peg_in_hole.search.probe import TouchProbe
from cellctl.processes.peg_in_hole.search.spiral_search import SpiralSearch
from cellctl.processes.peg_in_hole.search.strategy import SearchStrategy
from cellctl.processes.peg_in_hole.search.tilted_valley import TiltedValley

STRATEGIES: Mapping[SearchName, SearchStrategy] = {
    strategy.name: strategy
    for strategy in (
        SpiralSearch(),
        TiltedValley(),
        ArcSearch(),
        ParticleMap(),
        PatentMidpoint(),
        PatentCircumcentre(),
    )
}


async def find_hole(
    probe: TouchProbe,
    order: tuple[SearchName, ...],
    first_contact: ContactClass = ContactClass.END_FACE,
) -> SearchName:
    """The strategy by which the peg has entered.

    A peg whose first contact is no face may stand in the mouth of its hole: it is pressed there, as
    the begin of the first strategy, which would lift it and touch down over the search centre.

    A map that is not exhausted then is the prior of one retry: the peg is lifted and looks round
    the place that is likeliest now, within the time of the search. Raises ``HoleAbsent`` when
    nothing is left, ``SearchGaveUp`` at the deadline before that.
    """
    if first_contact is not ContactClass.END_FACE and await probe.enters():
        return order[0]
    for name in order:
        if await STRATEGIES[name].find(probe):
            return name
    looked = "the whole map"
    if not probe.hole_map.exhausted:
        probe.hole_map.begin_again()
        if await probe.look_round(probe.hole_map.likeliest_m(), 2 * probe.task.fit.catch_radius_m):
            return SearchName.SPIRAL
        looked = "what these strategies reach, nor round the likeliest place of the rest"
    tried = ", ".join(order)
    raise HoleAbsent(f"{tried} found none in {looked}, {len(probe.trace.points)} points felt")
