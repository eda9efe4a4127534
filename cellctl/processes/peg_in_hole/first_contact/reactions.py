"""What follows from the class of a contact: at the first touch of the face, and after the entry.

Source: section 2 (S3) of the study of insertion by touch.
"""

from cellctl.cell.contact_motion.motions import ContactMotions
from cellctl.processes.peg_in_hole.faults import WrongFeature
from cellctl.processes.peg_in_hole.first_contact.classify import (
    LIGHT_N,
    ClassifiedContact,
    ContactClass,
    classify_contact,
)
from cellctl.processes.peg_in_hole.plan.parameters import SearchParameters
from cellctl.processes.peg_in_hole.plan.task import SearchTask
from cellctl.processes.peg_in_hole.search.conditions import LostSupport

_TRIES = 3
"""How often an edge is given way to before the search takes over."""

Contacts = list[ClassifiedContact]
"""Contacts in their order in time; a cycle keeps them for its record."""


async def meet_face(
    motions: ContactMotions, task: SearchTask, parameters: SearchParameters, contacts: Contacts
) -> None:
    """The first contact: an edge or a wall is given way to, a peg held by friction pressed less.

    What is still neither face nor hole after three times is left to the search. Raises
    ``WrongFeature``.
    """
    press_n = LIGHT_N
    for _ in range(_TRIES):
        contact = await classify_contact(motions, task, parameters.touch_speed.value, press_n)
        contacts.append(contact)
        if contact.found in (ContactClass.END_FACE, ContactClass.ALIGNED):
            return
        _require_round(contact, task)
        if contact.found is ContactClass.STUCK:
            press_n /= 2
        else:
            # With the press of the search, for which the time is: a lighter one would move a stiff
            # arm by a fraction of the way only.
            slides_n, give_way_s = parameters.press_n.value, parameters.give_way_time.value
            await motions.comply(slides_n, give_way_s, LostSupport(slides_n), turns=False)


async def require_walls(
    motions: ContactMotions, task: SearchTask, parameters: SearchParameters, contacts: Contacts
) -> None:
    """A peg that is deeper than the entry has walls to its sides; raises ``WrongFeature``."""
    contact = await classify_contact(motions, task, parameters.touch_speed.value)
    contacts.append(contact)
    _require_round(contact, task)
    deep = float(contact.sample.task_position_tip_m[2]) > task.fit.entry_depth_m
    if deep and contact.found is ContactClass.END_FACE:
        raise WrongFeature(f"{_place(contact)}: nothing resists to any side")


def _require_round(contact: ClassifiedContact, task: SearchTask) -> None:
    if contact.found is ContactClass.WRONG_FEATURE:
        within_mm = 2e3 * task.fit.clearance_m
        raise WrongFeature(
            f"{_place(contact)}: walls at two opposite sides only, at the others none within the "
            f"play of {within_mm:.2f} mm"
        )


def _place(contact: ClassifiedContact) -> str:
    x_mm, y_mm, z_mm = 1e3 * contact.sample.task_position_tip_m
    return f"x {x_mm:.2f}, y {y_mm:.2f} mm, depth {z_mm:.2f} mm"
