"""Both fakes of a controller, one after the other."""

from collections.abc import AsyncIterator
from typing import cast

import pytest

from tests.rigs.wire.any_rig import AnyRig, Make
from tests.rigs.wire.job_rig import job_rig
from tests.rigs.wire.sjl_rig import sjl_rig


@pytest.fixture(params=[sjl_rig, job_rig], ids=["records", "jobs"])
def make(request: pytest.FixtureRequest) -> Make:
    """The fake that is written from the protocol, or the one that runs the shipped job files."""
    return cast(Make, request.param)


@pytest.fixture
async def rig(make: Make) -> AsyncIterator[AnyRig]:
    async with make() as rig:
        await rig.connect()
        yield rig
