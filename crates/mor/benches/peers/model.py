"""POD with interpolated coefficients by EZyRB and `Podiann`: errors at points left out, CPU time.

    pip install numpy ezyrb
    python3 crates/mor/benches/peers/model.py [ROUNDS]

Cases: a pulse that travels a period in 601 times, every second left out, 40 modes (as in the bench
`interpolation`); sin(3x - t mu) + 0.3 mu^2 cos 5x cos 2t at 41 times and 8 mu in [1, 2], errors at
7 mu between, 10 modes. Inputs are scaled to [0, 1]. Networks: tanh, 24 + 24, 300 iterations
(`Podiann`); coefficients scaled to unit deviation (plugin DatabaseScaler), Adam with 10 000 epochs
(EZyRB). Times are those of POD, fit and prediction; `Podiann` has error estimates as well, from
further fits.
"""

import io
import statistics
import sys
import tempfile
from contextlib import redirect_stdout
from pathlib import Path

from ours import ours, timed

import numpy as np


def pulse():
    t = np.arange(601) / 600
    away = (np.arange(400) + 0.5)[:, None] / 400 - (0.1 + t)
    field = np.exp(-((away - np.round(away)) / 0.05) ** 2)
    return field[:, ::2], t[::2, None], field[:, 1::2], t[1::2, None], 40


def wave():
    x, times = np.linspace(0, 2 * np.pi, 200, endpoint=False), np.linspace(0, 1, 41)

    def at(mus):
        points = np.array([(t, mu) for mu in mus for t in times])
        t, mu = points.T
        x_ = x[:, None]
        return np.sin(3 * x_ - t * mu) + 0.3 * mu**2 * np.cos(5 * x_) * np.cos(2 * t), points

    mus = np.linspace(1, 2, 8)
    known, points = at(mus)
    held, held_points = at(0.5 * (mus[1:] + mus[:-1]))
    low = points.min(0)
    scale = points.max(0) - low
    return known, (points - low) / scale, held, (held_points - low) / scale, 10


def ezyrb(approximation):
    def run(known, points, held, held_points, rank):
        import ezyrb
        import torch
        from sklearn.preprocessing import StandardScaler
        from ezyrb.plugin import DatabaseScaler

        torch.set_num_threads(1)
        torch.manual_seed(1)
        plugins = []
        if approximation == "network":
            fitted = ezyrb.ANN([24, 24], torch.nn.Tanh(), [10_000], frequency_print=10**9)
            plugins = [DatabaseScaler(StandardScaler(), "reduced", "snapshots")]
        else:
            fitted = ezyrb.RBF(approximation)
        database = ezyrb.Database(points, np.ascontiguousarray(known.T))
        pod = ezyrb.POD("svd", rank=rank)
        model = ezyrb.ReducedOrderModel(database, pod, fitted, plugins=plugins)
        with redirect_stdout(io.StringIO()):
            model.fit()
            found = model.predict(ezyrb.Database(held_points)).snapshots_matrix
        return np.linalg.norm(found.T - held) / np.linalg.norm(held)

    return run


METHODS = [
    ("cubic", ("cubic",), "cubic"),
    ("thin plate", ("thin plate",), "thin_plate_spline"),
    ("quintic", ("quintic",), "quintic"),
    ("network", ("network", 300, 24, 24), "network"),
    ("best", ("best",), None),
]


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    ezyrb("cubic")(*wave())  # imports
    for case in (pulse, wave):
        known, points, held, held_points, rank = data = case()
        with tempfile.TemporaryDirectory() as folder:
            names = ("snapshots", "points", "held", "held_points")
            for name, array in zip(names, (known.T, points, held.T, held_points)):
                np.save(Path(folder) / name, np.ascontiguousarray(array))
            for name, arguments, peer in METHODS:
                a, b = [], []
                for _ in range(rounds):
                    o = ours("model", folder, rank, *arguments)
                    a.append(o["cpu"] + o["predict"])
                    if peer:
                        error, cpu, _ = timed(lambda: ezyrb(peer)(*data))
                        b.append(cpu)
                theirs = f"EZyRB {error:.2e} {statistics.median(b):8.3f} CPU s" if peer else ""
                print(
                    f"{case.__name__:6} {name:10} projection {o['projection']:.2e} "
                    f"ours {o['error']:.2e} "
                    f"{statistics.median(a):8.4f} CPU s  {theirs}  {o['method']}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
