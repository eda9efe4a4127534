"""Does the machine itself stand still? One highest-priority thread a processor, ticking at 1 kHz.

On a virtual machine the host takes processors away for tens of milliseconds. A tick that comes more
than 300 µs late is such a stall: no program could have answered then. The monitor is C, because the
interpreter itself could be that late; it is compiled with the system's compiler ``cc``.
"""

import signal
import subprocess
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Stalls = NDArray[np.float64]
"""Shape (n, 2): begin and end, monotonic seconds."""

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
        source, program = folder / "stalls.c", folder / "stalls"
        source.write_text(_SOURCE)
        subprocess.run(["cc", "-O2", "-pthread", "-o", str(program), str(source)], check=True)
        self._process = subprocess.Popen([str(program)], stdout=subprocess.PIPE)

    def stop(self) -> Stalls:
        """End the monitor."""
        self._process.send_signal(signal.SIGTERM)
        text, _ = self._process.communicate(timeout=10)
        rows = [[float(value) for value in line.split()] for line in text.splitlines()]
        return np.array(sorted(rows)).reshape(-1, 2)


def touched(
    begin_s: NDArray[np.float64], end_s: NDArray[np.float64], stalls: Stalls
) -> NDArray[np.bool_]:
    """Which intervals overlap a stall."""
    if len(stalls) == 0:
        return np.zeros(len(begin_s), bool)
    reach_s = np.maximum.accumulate(stalls[:, 1])
    before = np.searchsorted(stalls[:, 0], end_s, side="right") - 1
    return (before >= 0) & (reach_s[np.maximum(before, 0)] >= begin_s)
