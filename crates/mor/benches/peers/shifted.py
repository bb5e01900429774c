"""Shifted POD by sPOD (J2, BFB, ALM) beside `ShiftedPod`, on the very same matrices.

    pip install numpy scipy scikit-learn
    EXPORT=FOLDER cargo bench -p siltflow-mor --bench shifted_outliers -- 3 0 0.1 0.5 1 3 5 8 12
    SPOD_LIB=FOLDER/lib python3 crates/mor/benches/peers/shifted.py clean FOLDER
    SPOD_LIB=FOLDER/lib python3 crates/mor/benches/peers/shifted.py wrong FOLDER

sPOD is no package: SPOD_LIB is the folder `lib` of github.com/Philipp137/SPOD. Parameters are
those of its example `01_travelling_wave_1D.py`: Lagrange polynomials of degree 5, ALM with mu =
M N/(4 sum |q|) and 10 modes more than needed (with wrong entries a tenth of that mu, lambda =
1/sqrt(max(M, N)) and 50 modes more), BFB with lambda_s = 0.3, at most 500 steps.
"""

import inspect
import io
import os
import sys
import tempfile
from contextlib import redirect_stdout
from pathlib import Path

from ours import ours, timed

import numpy as np

sys.path.insert(0, os.environ["SPOD_LIB"])
from sPOD_algo import sPOD_Param, shifted_POD_ALM, shifted_POD_FB, shifted_POD_J2
from transforms import Transform


def examples():
    """Cases of sPOD's example: snapshots, shifts in cells, ranks."""
    cells, times = 400, 200
    t = np.arange(times) / times * 0.5
    x = np.arange(cells)[:, None] / cells
    pulse = lambda place, width: np.exp(-(((x - place + 0.5) % 1.0 - 0.5) / width) ** 2)
    q = pulse(0.1 + t, 0.015) + pulse(0.9 - t, 0.015)
    yield "crossing_waves 400 x 200", q, cells * np.array([t, -t]), [1, 1]
    left = sum(np.sin(4 * np.pi * r * t) * pulse(0.5 + 0.1 * r - t, 0.0125) for r in range(1, 5))
    right = sum(np.cos(4 * np.pi * r * t) * pulse(0.2 + 0.1 * r + t, 0.0125) for r in range(1, 3))
    yield "multiple_ranks 400 x 200", left + right, cells * np.array([-t, t]), [4, 2]


def call(algorithm, data, frames, params, ranks, **more):
    """With the names of arguments that this version of sPOD has."""
    names = inspect.signature(algorithm).parameters
    more["nmodes" if "nmodes" in names else "nmodes_max"] = ranks
    more = {name: value for name, value in more.items() if name in names}
    return algorithm(data, frames, myparams=params, **more)


def spod(method, data, shifts, ranks, wrong=False):
    """Its approximation and ranks (singular values above 1e-10 of the largest)."""
    m, n = data.shape
    shape = [m, 1, 1, n]
    with redirect_stdout(io.StringIO()):
        frames = [Transform(shape, [m], shifts=-s, dx=[1.0], interp_order=5) for s in shifts]
        params = sPOD_Param()
        params.maxit, params.isVerbose, params.isError = 500, False, wrong
        mu = m * n / (4 * np.abs(data).sum())
        if method == "J2":
            found = call(shifted_POD_J2, data, frames, params, ranks)
        elif method == "BFB":
            params.lambda_s = 0.3
            found = call(shifted_POD_FB, data, frames, params, ranks, method="BFB")
        else:
            params.lambda_E = 1 / np.sqrt(max(m, n))
            most, mu = (max(ranks) + 50, 0.1 * mu) if wrong else (max(ranks) + 10, mu)
            found = call(shifted_POD_ALM, data, frames, params, most, mu=mu, isError=wrong)
    values = [frame.modal_system["sigma"] for frame in found.frames]
    found_ranks = [int((s > 1e-10 * s[0]).sum()) for s in values]
    return found.data_approx, found_ranks, len(found.rel_err_hist)


def report(name, method, result, clean):
    (approximation, ranks, steps), cpu, _ = result
    error = np.linalg.norm(approximation - clean) / np.linalg.norm(clean)
    end = f"ranks {ranks} {steps:4} steps {cpu:7.2f} CPU s"
    print(f"{name:28} sPOD {method:4} error {error:.2e} {end}", flush=True)


def clean(rounds):
    cases = [(name, q, shifts, ranks) for name, q, shifts, ranks in examples()]
    if len(sys.argv) > 2:
        for folder in sorted(Path(sys.argv[2]).glob("seed*_part0")):
            data, shifts = np.load(folder / "clean.npy").T, np.load(folder / "shifts.npy")
            cases.append((folder.name.split("_")[0] + " 512 x 60", data, shifts, [3, 2]))
    for name, data, shifts, ranks in cases:
        with tempfile.TemporaryDirectory() as folder:
            for file, array in (("data", data.T), ("clean", data.T), ("shifts", shifts)):
                np.save(Path(folder) / file, np.ascontiguousarray(array))
            for _ in range(rounds):
                given = ",".join(map(str, ranks))
                for given, tolerance in ((given, 1e-10), (given, 1e-14), ("found", 1e-10)):
                    o = ours("shifted", folder, given, tolerance)
                    print(
                        f"{name:28} ours {given:5} to {tolerance:.0e} error {o['error']:.2e} ranks "
                        f"{[int(r) for r in o['ranks']]} {int(o['steps']):4} steps "
                        f"{o['cpu']:7.3f} CPU s",
                        flush=True,
                    )
                for method in ("J2", "BFB", "ALM"):
                    report(name, method, timed(lambda: spod(method, data, shifts, ranks)), data)


def wrong(folder):
    for case in sorted(Path(folder).glob("seed*_part*")):
        data, exact = (np.load(case / f"{n}.npy").T for n in ("data", "clean"))
        shifts = np.load(case / "shifts.npy")
        for method in ("ALM", "BFB"):
            result = timed(lambda: spod(method, data, shifts, [3, 2], wrong=True))
            report(case.name, method, result, exact)


if __name__ == "__main__":
    if sys.argv[1] == "clean":
        clean(int(os.environ.get("ROUNDS", 1)))
    else:
        wrong(sys.argv[2])
