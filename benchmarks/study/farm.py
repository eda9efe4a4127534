"""Gives seeds to the workers of Dask and takes their results, however long some take."""

import itertools
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from distributed import Client, Future, KilledWorker, LocalCluster, as_completed

from benchmarks.study.farm_error import FarmError
from benchmarks.study.kinds import Scales, run_seed
from benchmarks.study.outcome import StudyOutcome
from benchmarks.study.results import source_digest

CONNECT_S = 20.0
_AHEAD = 3
"""Seeds that wait for each worker: enough to keep it busy, few to be lost by Ctrl-C."""


@contextmanager
def farm(scheduler: str | None, workers: int, *, connect_s: float = CONNECT_S) -> Iterator[Client]:
    """A cluster of this computer, or the one of a scheduler; raises ``FarmError``."""
    if scheduler is None:
        with (
            LocalCluster(
                n_workers=workers, threads_per_worker=1, dashboard_address=None, host="127.0.0.1"
            ) as cluster,
            Client(cluster) as client,
        ):
            yield client
        return
    try:
        client = Client(scheduler, timeout=connect_s)
    except (OSError, TimeoutError, ValueError) as error:
        raise FarmError(f"no scheduler at {scheduler}: {error}") from error
    with client:
        _require_same_source(client)
        yield client


def _require_same_source(client: Client) -> None:
    """Workers elsewhere have a checkout of their own; a result of another one would be a lie."""
    try:
        found: dict[str, str] = client.run(source_digest)
    except Exception as error:  # what a worker raises comes here as it is, import errors included
        raise FarmError(f"a worker cannot run this checkout: {error}") from error
    if not found:
        raise FarmError("the scheduler has no workers")
    here = source_digest()
    other = [address for address, digest in found.items() if digest != here]
    if other:
        raise FarmError(f"workers with another state of the source: {', '.join(other)}")


def run_seeds(
    client: Client,
    kind: str,
    seeds: Iterable[int],
    scales: Scales,
    took: Callable[[StudyOutcome], object],
) -> None:
    """Run every seed once; ``took`` is called with each result in the order of their ends.

    A seed that kills its worker three times is a result, too, and so is one that raises.
    """
    waiting = iter(seeds)
    ahead = _AHEAD * max(1, len(client.scheduler_info()["workers"]))

    def submitted(seed: int) -> Future:
        # A call that is not pure never takes a result of an earlier study of the same scheduler.
        return client.submit(run_seed, kind, seed, dict(scales), pure=False, key=_key(kind, seed))

    first = [submitted(seed) for seed in itertools.islice(waiting, ahead)]
    running = as_completed(first)
    for future in running:
        took(_outcome(future))
        future.release()
        if (seed := next(waiting, None)) is not None:
            running.add(submitted(seed))


_study = itertools.count()


def _key(kind: str, seed: int) -> str:
    return f"{kind}-{next(_study)}-{seed}"


def _outcome(future: Any) -> StudyOutcome:
    seed = int(future.key.rpartition("-")[2])
    error = future.exception()
    if error is None:
        return StudyOutcome.of(future.result())
    if isinstance(error, KilledWorker):
        fault = "its worker died each time that it was tried: out of memory?"
    else:
        fault = f"{type(error).__name__}: {error}"
    return StudyOutcome(seed, good=False, called_good=False, fault=fault)
