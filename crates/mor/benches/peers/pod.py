"""POD of 45 000 x 601 snapshots with known singular values beside NumPy, scikit-learn and pyMOR.

    pip install numpy scipy scikit-learn pymor
    python3 crates/mor/benches/peers/pod.py [DECADES [ROUNDS [METHOD ...]]]

sigma_k = 10^(-DECADES (k - 1)/39): DECADES orders of magnitude over the first 40. In every round
each method runs once, on one thread; medians of CPU and wall seconds, errors relative to sigma_k.
"""

import os
import statistics
import sys
import tempfile

from ours import ours, timed

import numpy as np
import scipy.linalg

ROWS, SNAPSHOTS, RANK = 45_000, 601, 40


def snapshots(decades):
    random = np.random.default_rng(1)
    u, v = (np.linalg.qr(random.standard_normal((n, SNAPSHOTS)))[0] for n in (ROWS, SNAPSHOTS))
    values = 10.0 ** (-decades * np.arange(SNAPSHOTS) / (RANK - 1))
    return np.asfortranarray((u * values) @ v.T), values[:RANK]


def gram(x):
    values, v = np.linalg.eigh(x.T @ x)
    s = np.sqrt(np.maximum(values[::-1][:RANK], 1e-300))
    return x @ (v[:, ::-1][:, :RANK] / s), s


def gram_cholesky(x):
    """The method of snapshots and one pass of Cholesky QR, as `SvdMethod::Snapshots` has it."""
    values, v = np.linalg.eigh(x.T @ x)
    s = np.sqrt(np.maximum(values[::-1][:RANK], 1e-300))
    v = v[:, ::-1][:, :RANK]
    modes = x @ (v / s)
    lower = np.linalg.cholesky(modes.T @ modes)
    u, s, _ = np.linalg.svd(lower.T @ (v * s).T, full_matrices=False)
    return modes @ scipy.linalg.solve_triangular(lower.T, u), s


def svd(x):
    u, s, _ = np.linalg.svd(x, full_matrices=False)
    return u[:, :RANK], s[:RANK]


def qr_svd(x):
    q, r = scipy.linalg.qr(x, mode="economic", check_finite=False)
    u, s, _ = np.linalg.svd(r)
    return q @ u[:, :RANK], s[:RANK]


def randomised(x):
    from sklearn.utils.extmath import randomized_svd

    how = dict(n_oversamples=10, n_iter=2, power_iteration_normalizer="QR", random_state=1)
    u, s, _ = randomized_svd(x, RANK, **how)
    return u, s


def pymor(method):
    def run(x):
        from pymor.algorithms.pod import pod
        from pymor.core.logger import set_log_levels
        from pymor.vectorarrays.numpy import NumpyVectorSpace

        set_log_levels({"pymor": "ERROR"})
        modes, s = pod(NumpyVectorSpace.from_numpy(x), modes=RANK, rtol=0.0, method=method)
        return modes.to_numpy(), s

    return run


PEERS = {
    "numpy gram + eigh": gram,
    "numpy gram + Cholesky QR": gram_cholesky,
    "numpy svd": svd,
    "scipy qr + svd": qr_svd,
    "sklearn randomized_svd": randomised,
    "pymor method_of_snapshots": pymor("method_of_snapshots"),
    "pymor qr_svd": pymor("qr_svd"),
}


def main():
    decades = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    wanted = lambda name: len(sys.argv) <= 3 or any(w in name for w in sys.argv[3:])
    x, exact = snapshots(decades)
    runs = {}

    def note(name, cpu, wall, s, skew):
        error = np.full(RANK, np.nan)
        error[: len(s)] = np.abs(np.asarray(s[:RANK]) / exact[: len(s)] - 1.0)
        runs.setdefault(name, []).append((cpu, wall, error, skew))

    with tempfile.NamedTemporaryFile(suffix=".npy") as file:
        np.save(file, x.T)
        file.flush()
        for _ in range(rounds):
            methods = ("auto", "snapshots", "qr", "randomised")
            for method in filter(lambda m: wanted("ours " + m), methods):
                found = ours("pod", file.name, method, RANK)
                note("ours " + method, found["cpu"], found["wall"], found["values"], found["skew"])
            for name in filter(wanted, PEERS):
                (modes, s), cpu, wall = timed(lambda: PEERS[name](x))
                skew = np.abs(modes.T @ modes - np.eye(modes.shape[1])).max()
                note(name, cpu, wall, s, skew)
    print(f"{'method':28} {'CPU s':>7} {'wall s':>7} {'skew':>8}  error of sigma_1, 10, 20, 40  modes")
    for name, all_ in runs.items():
        cpu, wall = (statistics.median(r[i] for r in all_) for i in (0, 1))
        _, _, error, skew = all_[-1]
        errors = " ".join(f"{error[k - 1]:8.1e}" for k in (1, 10, 20, 40))
        print(f"{name:28} {cpu:7.3f} {wall:7.3f} {skew:8.1e}  {errors}  {np.isfinite(error).sum()}")


if __name__ == "__main__":
    main()
