"""Runs the bench `public_code` and returns what it prints."""

import os

for threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

import resource
import subprocess
import time

BENCH = ["cargo", "bench", "-q", "-p", "mor", "--bench", "public_code", "--"]


def ours(*arguments):
    """Names and values of its line; lists where several numbers follow a name."""
    line = subprocess.run(
        [*BENCH, *map(str, arguments)], check=True, capture_output=True, text=True
    ).stdout.strip().splitlines()[-1]
    found, name = {}, None
    for word in line.replace("[", "").replace("]", "").replace(",", " ").split():
        try:
            found[name].append(float(word))
        except (KeyError, ValueError):
            if name is not None and found[name] == []:
                found[name].append(word)
            else:
                name = word
                found[name] = []
    return {key: value[0] if len(value) == 1 else value for key, value in found.items()}


def timed(run):
    """Result, CPU and wall seconds."""
    usage = resource.getrusage(resource.RUSAGE_SELF)
    before, start = usage.ru_utime + usage.ru_stime, time.perf_counter()
    result = run()
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return result, usage.ru_utime + usage.ru_stime - before, time.perf_counter() - start
