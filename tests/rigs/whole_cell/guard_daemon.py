"""A daemon with nothing but a guard, to be killed; arguments: ports of sensor and GRD."""

import asyncio
import sys

from cellctl import log
from cellctl.guard.client import GuardClient
from tests.rigs.whole_cell.guard_rig import NOTHING, PATIENT, SETTINGS


async def main(sensor_port: int, guard_port: int) -> None:
    client = GuardClient(
        "sri",
        {"transport": "tcp", "host": "127.0.0.1", "port": sensor_port},
        "siasun-sjl",
        {"robot_name": "SR500A", "guard_port": guard_port},
        SETTINGS,
    )
    await client.start()
    await client.set_gravity_compensation(NOTHING)
    while client.health().flange_age_s > 1.0:  # noqa: ASYNC110 - lies in another process
        await asyncio.sleep(0.01)
    await client.arm(PATIENT)
    print(client.pid, flush=True)
    await asyncio.Event().wait()


if __name__ == "__main__":
    log.configure()
    asyncio.run(main(int(sys.argv[1]), int(sys.argv[2])))
