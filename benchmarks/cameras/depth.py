"""``python -m benchmarks.cameras.depth``: what 12 bit gain over 8 bit in the centre of a disc.

Rendered discs of which the centre is known, seen by a usual sensor and by one with little noise, in
good and in poor light. Each set of exposures is used five ways: as single images of 8 and 12 bit,
as the mean of k images of 8 bit rounded to 8 bit (a burst of the driver), as the mean of k images
of 12 bit kept as it is, and as the mean of the centres of k images of 8 bit (as steps average).
"""

from collections.abc import Iterable

import numpy as np
import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.cameras.disc_images import (
    SIZE_PX,
    Array,
    Light,
    Sensor,
    centre_px,
    drawn,
    eight_bit,
    exposed,
)

SENSORS = (Sensor("10 ke", 10_500.0, 2.5), Sensor("100 ke", 100_000.0, 5.0))
"""A usual one of 5 megapixels with pixels of 3.45 µm, and the largest wells that are sold."""
LIGHTS = (Light("good, 30 to 85 %", 0.30, 0.85), Light("poor, 4 to 8 %", 0.04, 0.08))
WAYS = ("8 bit", "12 bit", "8 bit, burst", "12 bit, burst", "8 bit, centres")


def main(discs: int = 100, burst: int = 16, seed: int = 1) -> None:
    """Scatter of the centre against truth, mpx for one coordinate, by sensor, light and way."""
    title = f"rms of a coordinate of the centre, mpx; {discs} discs, k = {burst}"
    table = Table("sensor", "light", *WAYS, title=title)
    for sensor in SENSORS:
        for light in LIGHTS:
            found = rms_px(sensor, light, discs, burst, seed)
            table.add_row(sensor.name, light.name, *(f"{found[way] * 1e3:.2f}" for way in WAYS))
    Console().print(table)
    typer.echo(f"the rms of {2 * discs} coordinates is itself known to {50 / discs**0.5:.0f} %")


def rms_px(sensor: Sensor, light: Light, discs: int, burst: int, seed: int) -> dict[str, float]:
    """Error of all coordinates, by way; both depths see the same exposures."""
    rng = np.random.default_rng(seed)
    errors: dict[str, list[Array]] = {way: [] for way in WAYS}
    for _ in track(range(discs), f"{sensor.name}, {light.name}", transient=True):
        truth = (SIZE_PX - 1) / 2 + rng.uniform(-0.5, 0.5, 2)
        ideal = drawn(truth, light)
        frames = [exposed(ideal, sensor, rng) for _ in range(burst)]
        for way, centre in _centres(frames, light):
            errors[way].append(centre - truth)
    return {way: float(np.sqrt(np.mean(np.square(found)))) for way, found in errors.items()}


def _centres(frames: list[np.ndarray], light: Light) -> Iterable[tuple[str, Array]]:
    eights = [eight_bit(frame) for frame in frames]
    singles = [centre_px(one.astype(float), light) for one in eights]
    yield "8 bit", singles[0]
    yield "12 bit", centre_px(frames[0].astype(float), light)
    yield "8 bit, burst", centre_px(np.rint(np.mean(eights, axis=0)), light)
    yield "12 bit, burst", centre_px(np.mean(frames, axis=0), light)
    yield "8 bit, centres", np.asarray(np.mean(singles, axis=0))


if __name__ == "__main__":
    typer.run(main)
