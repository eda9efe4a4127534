"""A kind as data: recipes, procedures, and what it must not be."""

import pytest

from cellctl.calibration.store.kind import CalibrationKind
from cellctl.errors.calibration import CalibrationRecordInvalid

PLAIN = CalibrationKind(name="lens", parse=lambda record: float(record["f_mm"]), procedures=(7,))
OF_RECIPE = CalibrationKind(name="stiffness", parse=dict, per_recipe=True, procedures=(4, 5))


def test_of_each_recipe_one() -> None:
    assert PLAIN.for_recipe(3) is PLAIN
    third = OF_RECIPE.for_recipe(3)
    assert (third.name, third.per_recipe) == ("stiffness_3", False)
    assert third.for_recipe(4) is third


@pytest.mark.parametrize(
    ("name", "included"), [("stiffness_3", True), ("stiffness", False), ("stiffness_x", False)]
)
def test_names_of_one_kind(name: str, included: bool) -> None:
    assert OF_RECIPE.includes(name) is included
    assert not PLAIN.includes(name)


def test_a_record_that_lacks_something_is_damaged() -> None:
    assert PLAIN.result({"f_mm": "12"}) == 12.0
    for record in ({}, {"f_mm": None}, {"f_mm": "long"}):
        with pytest.raises(CalibrationRecordInvalid, match="lens"):
            PLAIN.result(record)


def test_who_makes_it() -> None:
    assert PLAIN.made_by == "procedure 7"
    assert OF_RECIPE.made_by == "procedures 4 and 5"
    assert CalibrationKind(name="other", parse=dict).made_by == ""


def test_no_register_shows_one_of_each_recipe() -> None:
    with pytest.raises(ValueError, match="no register"):
        CalibrationKind(name="other", parse=dict, per_recipe=True, register="stereo")
