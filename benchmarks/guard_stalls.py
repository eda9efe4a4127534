"""Does the machine itself stand still? One highest-priority thread a processor, ticking at 1 kHz.

On a virtual machine the host takes processors away for tens of milliseconds. A tick that comes more
than 300 µs late is such a stall: no program could have answered then. Compiled with the system's C
compiler; without one the same thing runs in Python, with a coarser threshold.
"""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Stalls = NDArray[np.float64]
"""Shape (n, 2): begin and end, monotonic seconds."""

C_LATE_S = 300e-6
PYTHON_LATE_S = 600e-6

_SOURCE = r"""
#define _GNU_SOURCE
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#define MOST 200000
#define CPUS 64
static const long PERIOD_NS = 1000000, LATE_NS = 300000;
static double stalls[CPUS][MOST][2];
static int counts[CPUS];

static double seconds(struct timespec t) { return t.tv_sec + t.tv_nsec * 1e-9; }

static void *watch(void *arg) {
    long cpu = (long)arg;
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(cpu, &set);
    pthread_setaffinity_np(pthread_self(), sizeof set, &set);
    struct sched_param param = {.sched_priority = 97};
    pthread_setschedparam(pthread_self(), SCHED_FIFO, &param);
    struct timespec due, now;
    clock_gettime(CLOCK_MONOTONIC, &due);
    for (;;) {
        due.tv_nsec += PERIOD_NS;
        if (due.tv_nsec >= 1000000000) { due.tv_nsec -= 1000000000; due.tv_sec++; }
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL);
        clock_gettime(CLOCK_MONOTONIC, &now);
        if (seconds(now) - seconds(due) > LATE_NS * 1e-9) {
            int n = counts[cpu];
            if (n < MOST) {
                stalls[cpu][n][0] = seconds(due);
                stalls[cpu][n][1] = seconds(now);
                counts[cpu] = n + 1;
            }
            due = now;
        }
    }
    return NULL;
}

int main(void) {
    sigset_t set;
    int signal_number;
    long cpus = sysconf(_SC_NPROCESSORS_ONLN);
    if (cpus > CPUS) cpus = CPUS;
    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    sigprocmask(SIG_BLOCK, &set, NULL);
    mlockall(MCL_CURRENT | MCL_FUTURE);
    for (long cpu = 0; cpu < cpus; cpu++) {
        pthread_t thread;
        pthread_create(&thread, NULL, watch, (void *)cpu);
    }
    sigwait(&set, &signal_number);
    for (long cpu = 0; cpu < cpus; cpu++)
        for (int n = 0; n < counts[cpu]; n++)
            printf("%.9f %.9f\n", stalls[cpu][n][0], stalls[cpu][n][1]);
    return 0;
}
"""


class StallMonitor:
    """Runs beside a measurement; ``stop`` gives the stalls."""

    def __init__(self, folder: Path) -> None:
        program = _compiled(folder)
        self.kind = "C" if program else "Python"
        commands = [[str(program)]] if program else _python_commands()
        self._processes = [subprocess.Popen(c, stdout=subprocess.PIPE) for c in commands]

    def stop(self) -> Stalls:
        """End the monitor."""
        rows: list[list[float]] = []
        for process in self._processes:
            process.send_signal(signal.SIGTERM)
            text, _ = process.communicate(timeout=10)
            rows += [[float(value) for value in line.split()] for line in text.splitlines()]
        return np.array(sorted(rows)).reshape(-1, 2)


def touched(begin_s: NDArray[np.float64], end_s: NDArray[np.float64], stalls: Stalls) -> NDArray:
    """Which intervals overlap a stall."""
    if len(stalls) == 0:
        return np.zeros(len(begin_s), bool)
    reach_s = np.maximum.accumulate(stalls[:, 1])
    before = np.searchsorted(stalls[:, 0], end_s, side="right") - 1
    return (before >= 0) & (reach_s[np.maximum(before, 0)] >= begin_s)


def _compiled(folder: Path) -> Path | None:
    compiler = shutil.which("cc")
    if compiler is None:
        return None
    source, program = folder / "stalls.c", folder / "stalls"
    source.write_text(_SOURCE)
    command = [compiler, "-O2", "-pthread", "-o", str(program), str(source)]
    built = subprocess.run(command, capture_output=True, check=False)
    return program if built.returncode == 0 else None


def _python_commands() -> list[list[str]]:
    return [[sys.executable, "-m", __name__, str(cpu)] for cpu in sorted(os.sched_getaffinity(0))]


def _watch(cpu: int) -> None:
    """The Python form of the monitor, for one processor."""
    ended = False

    def end(*_: object) -> None:
        nonlocal ended
        ended = True

    signal.signal(signal.SIGTERM, end)
    os.sched_setaffinity(0, {cpu})
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(97))
    due_s = time.monotonic()
    found: list[tuple[float, float]] = []
    while not ended:
        due_s += 1e-3
        time.sleep(max(0.0, due_s - time.monotonic()))
        now_s = time.monotonic()
        if now_s - due_s > PYTHON_LATE_S:
            found.append((due_s, now_s))
            due_s = now_s
    for begin_s, end_s in found:
        print(f"{begin_s:.9f} {end_s:.9f}")


if __name__ == "__main__":
    _watch(int(sys.argv[1]))
