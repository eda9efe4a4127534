"""What is said of a value that does not fit its model."""

from typing import Annotated, Self

import pytest
from pydantic import BaseModel, Field, ValidationError, model_validator

from cellctl.config.document.findings import model_issues, validated
from cellctl.config.issue import ConfigIssue


class Remedy(BaseModel):
    text: str
    remedy: str


class Section(BaseModel):
    board: Annotated[str, Field(pattern=r"^\d+x\d+$", examples=["9x6"])] = "9x6"
    name: Annotated[str, Field(pattern=r"^[a-z_]+$")] = "cell"
    com_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    errors: dict[str, Remedy] = Field(default_factory=dict)
    low: float = 1.0
    high: float = 2.0

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.low >= self.high:
            raise ValueError("low must be less than high")
        return self


def only_issue(raw: dict[str, object]) -> ConfigIssue:
    with pytest.raises(ValidationError) as raised:
        validated(Section, raw)
    (issue,) = model_issues("part.", raised.value, Section, raw)
    return issue


def test_a_pattern_is_an_example_and_what_was_meant() -> None:
    assert only_issue({"board": "9*6"}).allowed == ("did you mean '9x6'? a text of the form '9x6'")
    assert only_issue({"name": "Cell One"}).allowed.startswith("did you mean 'cell_one'? ")
    assert only_issue({"board": "large"}).allowed == "a text of the form '9x6'"


def test_a_table_is_shown_with_its_keys() -> None:
    issue = only_issue({"errors": {"2105": "Collision"}})
    assert issue.key == "part.errors.2105"
    assert issue.allowed == "a table: { text = …, remedy = … }"


def test_twice_as_many_numbers_are_decimal_commas() -> None:
    issue = only_issue({"com_mm": [30, 0, 20, 0, 460, 0]})
    assert issue.allowed == "at most 3 entries, these are 6; a number has a decimal point, no comma"
    assert only_issue({"com_mm": [1, 2, 3, 4]}).allowed == "at most 3 entries, these are 4"


def test_keys_that_contradict_each_other_are_shown_with_their_values() -> None:
    issue = only_issue({"low": 3.0, "high": 2.0, "board": "9x6"})
    assert (issue.key, issue.value) == ("part.low", "3.0, high = 2.0")
    assert issue.allowed == "low must be less than high"
    assert only_issue({"low": 3.0}).value == "3.0"
