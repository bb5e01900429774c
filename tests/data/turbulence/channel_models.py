"""u+ of k-omega SST (2003) and k-omega (Wilcox 1988) in a developed channel, from their equations alone: what a wall-resolved run should give.

Half a channel in wall units, tau = 1 - y/Re_tau = (1 + nu_t) du/dy, k and omega by finite volumes on n cells that grow geometrically from
y+ 0.05, omega = 6/(beta y^2) below y+ 0.3. With 750 and 3000 cells the bulk velocity is the same to 2e-5.

    python3 channel_models.py [Re_tau] > channel_models_590.csv        (numpy, scipy)
"""
import sys

import numpy as np
from scipy.linalg import solve_banded

CELLS, FIRST = 3000, 0.05
A_1, BETA_STAR, RELAX = 0.31, 0.09, 0.999
WILCOX = dict(k=0.5, omega=0.5, beta=0.075, gamma=5 / 9)
NEAR, FAR = dict(WILCOX, k=0.85), dict(k=1.0, omega=0.856, beta=0.0828, gamma=0.44)


def solve(re, sst, n):
    faces = np.geomspace(FIRST, re, n + 1)
    y, h = 0.5 * (faces[1:] + faces[:-1]), np.diff(faces)
    near, far = (NEAR, FAR) if sst else (WILCOX, WILCOX)
    tau = 1 - y / re
    pinned = np.searchsorted(y, 0.3)
    power = 0.5 * (1 + np.sqrt(1 + 24 * BETA_STAR / near["beta"]))  # k ~ y^power beside the wall

    def transport(diffusivity, source, sink, phi, given):
        g = 0.5 * (diffusivity[1:] + diffusivity[:-1]) / np.diff(y)
        lower, upper = np.append(0, -g), np.append(-g, 0)
        centre = sink * h - lower - upper
        rhs = source * h + centre * (1 / RELAX - 1) * phi
        centre = centre / RELAX
        for i, value in enumerate(given):
            centre[i], lower[i], upper[i], rhs[i] = 1, 0, 0, value
        return solve_banded((1, 1), [np.append(0, upper[:-1]), centre, np.append(lower[1:], 0)], rhs)

    k = 3.3 * (y / (y + 8)) ** 3.2 * (1 - 0.7 * y / re)
    omega = 6 / (near["beta"] * y**2) + 8 / np.minimum(y, 0.2 * re)
    f_1, nu_t = np.ones(n), k / omega
    for _ in range(20000):
        blend = lambda name: f_1 * near[name] + (1 - f_1) * far[name]
        strain = tau / (1 + nu_t)
        produced, cross = strain**2, np.zeros(n)
        if sst:
            produced = np.minimum(produced, 10 * BETA_STAR * k * omega / nu_t)
            cross = 2 * far["omega"] * np.gradient(k, y) * np.gradient(omega, y) / omega
        more = (1 - f_1) * cross
        new_omega = transport(
            1 + blend("omega") * nu_t,
            blend("gamma") * produced + np.maximum(more, 0),
            blend("beta") * omega + np.maximum(-more, 0) / omega,
            omega,
            6 / (near["beta"] * y[:pinned] ** 2),
        )
        new_k = transport(
            1 + blend("k") * nu_t, nu_t * produced, BETA_STAR * new_omega, k, [k[1] * (y[0] / y[1]) ** power]
        )
        change = max(abs(new_k / k - 1).max(), abs(new_omega / omega - 1).max())
        k, omega = new_k, new_omega
        if sst:
            a, b = np.sqrt(k) / (BETA_STAR * omega * y), 500 / (y**2 * omega)
            third = 4 * far["omega"] * k / (np.maximum(cross, 1e-10) * y**2)
            f_1 = 0.5 * (f_1 + np.tanh(np.minimum(np.minimum(np.maximum(a, b), third), 5) ** 4))
            f_2 = np.tanh(np.minimum(np.maximum(2 * a, b), 10) ** 2)
            nu_t = 0.5 * (nu_t + A_1 * k / np.maximum(A_1 * omega, strain * f_2))
        else:
            nu_t = k / omega
        if change < 1e-9:
            break
    slope = tau / (1 + nu_t)
    return y, FIRST + np.cumsum(slope * h) - 0.5 * slope * h, h


if __name__ == "__main__":
    re_tau = float(sys.argv[1]) if len(sys.argv) > 1 else 587.19
    (y, sst, h), (_, wilcox, _) = (solve(re_tau, sst, CELLS) for sst in (True, False))
    bulk = [(np.sum(u * h) + 0.5 * FIRST**2) / re_tau for u in (sst, wilcox)]
    print(f"# y+, u+ of k-omega SST, u+ of k-omega 1988; channel at Re_tau {re_tau}, bulk u+ {bulk[0]:.4f} and {bulk[1]:.4f}; channel_models.py")
    for at in np.append(np.geomspace(0.3, 0.988 * re_tau, 60), re_tau * 0.999):
        print(f"{at:.5g},{np.interp(at, y, sst):.5f},{np.interp(at, y, wilcox):.5f}")
