"""The figures of a site in the job files, as the installation sheet names their places."""

import pytest

from fakes.robot_jobs.installation import SHIPPED, Adaptation, installed
from fakes.robot_jobs.lexer import JobError

SITE = Adaptation("T90A-1", step_max_mm=0.25, deadman_ms=1000)
JOBS = ("SJLMAIN", "SJLSTA", "SJLGRD")


def text(job: str) -> str:
    return (SHIPPED / f"{job}.job").read_text("ascii")


@pytest.mark.parametrize("job", JOBS)
def test_the_hello_names_the_site(job: str) -> None:
    adapted = SITE.applied(text(job), job)
    assert ",T90A-1,2.2,EUL=ZYX,UNIT=MMDEG,STEPMAX=0.2500,DEADMAN=1000,ACC=1000.0000;" in adapted
    assert "SR500A" not in adapted


@pytest.mark.parametrize("job", JOBS)
def test_only_the_places_of_the_sheet_change(job: str) -> None:
    pairs = zip(text(job).splitlines(), SITE.applied(text(job), job).splitlines(), strict=True)
    assert sum(old != new for old, new in pairs) == 2


def test_the_limits_that_the_jobs_use_are_those_that_they_say() -> None:
    assert "IF R[14] > 0.2505 : GOTO" in SITE.applied(text("SJLMAIN"), "SJLMAIN")
    assert "IF I[303] <= 1000 : GOTO" in SITE.applied(text("SJLSTA"), "SJLSTA")
    assert "IF I[403] <= 1000 : GOTO" in SITE.applied(text("SJLGRD"), "SJLGRD")


def test_the_adapted_files_are_jobs() -> None:
    assert set(installed(SHIPPED, SITE)) == set(installed(SHIPPED, None)) == set(JOBS)


def test_a_file_without_such_a_place_is_refused() -> None:
    with pytest.raises(JobError, match="DEADMAN"):
        SITE.applied(text("SJLSTA").replace("DEADMAN=300", ""), "SJLSTA")
