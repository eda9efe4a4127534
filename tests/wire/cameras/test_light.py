"""`cellctl grab` with a lamp at a coupler: lit while the fake camera takes its picture."""

import asyncio
from pathlib import Path

from typer.testing import CliRunner

from cellctl.cli.commands import app_with
from cellctl.clock import now_s
from cellctl.interfaces.camera import PixelFormat
from fakes.wire.cameras.image_server import ImageServer, Picture
from fakes.wire.couplers.coupler import CouplerServer
from tests.wire.cameras.camera_bench import PictureTaker

RING = 2
CELL = """name = "bench"
[cameras.eye]
driver = "frame-server"
simulated = true
light = {{ device = "lamps", output = "ring", settle_s = 0.01 }}
settings = {{ host = "127.0.0.1", port = {camera} }}
[digital_ios.lamps]
driver = "modbus-coupler"
simulated = true
settings = {{ host = "127.0.0.1", port = {coupler}, outputs = {{ ring = {ring} }} }}
"""


class LitTaker(PictureTaker):
    """Notes whether the lamp is lit when a picture is taken."""

    def __init__(self, coupler: CouplerServer) -> None:
        super().__init__(PixelFormat.MONO8)
        self.lit: list[bool] = []
        self._coupler = coupler

    async def take(self, faults: frozenset[str]) -> Picture:
        self.lit.append(self._coupler.outputs[RING])
        return await super().take(faults)


async def test_pictures_are_taken_in_the_light(tmp_path: Path) -> None:
    switched: list[bool] = []
    coupler = CouplerServer(
        now_s,
        inputs=lambda _: {},
        output_addresses=[RING],
        on_outputs=lambda _, outputs: switched.append(outputs[RING]),
        watchdog_ms=900,
    )
    taker = LitTaker(coupler)
    server = ImageServer("127.0.0.1", 0, taker.take)
    await server.start()
    path = tmp_path / "cell.toml"
    path.write_text(CELL.format(camera=server.port, coupler=await coupler.start(), ring=RING))
    app = app_with("grab")
    assert app is not None
    words = ["grab", str(path), "--camera", "eye", "--out", str(tmp_path), "--count", "2"]
    done = await asyncio.to_thread(CliRunner().invoke, app, words)
    await server.stop()
    await coupler.stop()
    assert done.exit_code == 0, done.exception
    assert taker.lit == [True, True]
    changes = [
        new for before, new in zip([False, *switched], switched, strict=False) if new != before
    ]
    assert changes == [True, False, True, False]
