#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The temperatures of case 16 without calx: the chain's equations by RK4, whose error is 1e-10 here.

Each contact carries the load, the plate and the weights above; Hertz gives its radius a and so its conductance 2 k a;
C dT_i/dt = H_i (T_(i-1) - T_i) + H_(i+1) (T_(i+1) - T_i), the source below, nothing above."""
import math
import sys

N, R, LOAD, PLATE, G = 15, 5e-3, 160.0, 0.01, 9.81
DENSITY, HEAT, CONDUCTIVITY, YOUNG, POISSON = 7800.0, 460.0, 46.0, 200e9, 0.3
COLD, HOT = 293.15, 380.15
STEP = 0.5  # s; C/H is 146 s

mass = DENSITY * 4 / 3 * math.pi * R**3
stiffness = YOUNG / (1 - POISSON**2) / 2
force = [LOAD + PLATE * G + (N - i) * mass * G for i in range(N)]  # below sphere i
C = mass * HEAT
H = [2 * CONDUCTIVITY * (3 * f * (R / 2 if i else R) / (4 * stiffness)) ** (1 / 3) for i, f in enumerate(force)]  # the source is flat


def rates(T):
    flow = [H[i] * ((T[i - 1] if i else HOT) - T[i]) for i in range(N)] + [0.0]
    return [(flow[i] - flow[i + 1]) / C for i in range(N)]


def ahead(T, rate, step):
    return [v + step * r for v, r in zip(T, rate)]


def after(T):
    a = rates(T)
    b = rates(ahead(T, a, STEP / 2))
    c = rates(ahead(T, b, STEP / 2))
    d = rates(ahead(T, c, STEP))
    return [v + STEP / 6 * (p + 2 * q + 2 * r + s) for v, p, q, r, s in zip(T, a, b, c, d)]


print(f"force below the first {force[0]:.9f} N, above the last {LOAD + PLATE * G:.4f} N; C/H {C / H[-1]:.2f} s")
T, t = [COLD] * N, 0.0
for end in map(float, sys.argv[1:] or ["600", "1800", "3600"]):
    while t < end - STEP / 2:
        T, t = after(T), t + STEP
    print(f"{t:6.0f} s: " + " ".join(f"{v:.5f}" for v in T), f" heat {C * (sum(T) - N * COLD):.6f} J")
