#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Ten small problems of rigid bodies, assembled here from places, masses and speeds alone and solved by Siconos, against one step of nscd:
the same impulses, to 1e-6 of the largest, where there is one solution (W is positive definite), and the same velocities where forces may be
distributed in several ways. Needs Debian's python3-siconos; without it there is nothing to compare with.

The tool is $CALX_CONTACT_PROBLEM (tests/bench/contact_problem.c), calx's plugins are in $CALX_PLUGINS."""

import json
import math
import os
import subprocess
import sys
import tempfile
import unittest

DEBIAN = "/usr/bin/python3"
try:
    import numpy as np
    import siconos.numerics as sn
except ImportError:
    if sys.executable != DEBIAN and os.path.exists(DEBIAN) and "CALX_TRIED_DEBIAN" not in os.environ:
        os.execve(DEBIAN, [DEBIAN, *sys.argv], {**os.environ, "CALX_TRIED_DEBIAN": "1"})  # another Python may come first
    sn = None

TOOL = os.environ.get("CALX_CONTACT_PROBLEM", "contact_problem")
STEP, REACH, SAME = 1e-3, 0.1, 1e-6  # s; of the smallest radius; of the largest impulse or speed
GRAVITY = 9.81
DOWN, AT_REST = (0.0, 0.0, -GRAVITY), (0.0, 0.0, 0.0)


class Body:
    def __init__(self, at, velocity=AT_REST, spin=AT_REST, radius=0.01, density=2500.0, fixed=False):
        self.at, self.velocity, self.spin = (np.array(v, float) for v in (at, velocity, spin))
        self.radius, self.density, self.fixed = radius, density, fixed
        mass = density * 4 / 3 * math.pi * radius**3
        self.inverse = [0.0 if fixed else 1 / mass] * 3 + [0.0 if fixed else 1 / (0.4 * mass * radius**2)] * 3


class Problem:
    """planes: (point, normal), the normal unit and towards the bodies. pull: N, between bodies."""

    def __init__(self, bodies, planes=(), mu=0.0, e=0.0, gravity=DOWN, pull=0.0):
        self.bodies, self.planes, self.mu, self.e, self.pull = bodies, planes, mu, e, pull
        self.gravity = np.array(gravity, float)
        self.contacts = list(self._find())

    def _find(self):
        """Where the bodies are half a step later: (i, j or -1, normal, gap, lever i, lever j). The point of contact is in the middle of the overlap."""
        at = [b.at + 0.5 * STEP * b.velocity for b in self.bodies]
        reach = REACH * min(b.radius for b in self.bodies)
        for i, a in enumerate(self.bodies):
            for j in range(i):
                b, way = self.bodies[j], at[i] - at[j]
                distance = np.linalg.norm(way)
                gap = distance - a.radius - b.radius
                if gap < reach and not (a.fixed and b.fixed):
                    yield i, j, way / distance, gap, a.radius + 0.5 * gap, b.radius + 0.5 * gap
            for point, normal in self.planes:
                gap = (at[i] - np.array(point, float)) @ np.array(normal, float) - a.radius
                if gap < reach:
                    yield i, -1, np.array(normal, float), gap, a.radius + 0.5 * gap, 0.0

    def assemble(self):
        rows = []
        for i, j, n, _, lever_i, lever_j in self.contacts:
            t = np.cross(n, [1.0, 0, 0] if abs(n[0]) < 0.7 else [0, 1.0, 0])
            t /= np.linalg.norm(t)
            for direction in (n, t, np.cross(n, t)):
                row = np.zeros(6 * len(self.bodies))
                # v_i - v_j + n x (l_i w_i + l_j w_j): the contact is at -l_i n from i, at l_j n from j
                row[6 * i:6 * i + 3], row[6 * i + 3:6 * i + 6] = direction, lever_i * np.cross(direction, n)
                if j >= 0:
                    row[6 * j:6 * j + 3], row[6 * j + 3:6 * j + 6] = -direction, lever_j * np.cross(direction, n)
                rows.append(row)
        h = np.array(rows)
        inverse = np.concatenate([b.inverse for b in self.bodies])
        before = np.concatenate([np.concatenate([b.velocity, b.spin]) for b in self.bodies])
        fall = np.concatenate([np.concatenate([AT_REST if b.fixed else STEP * self.gravity, AT_REST]) for b in self.bodies])
        w, q = h * inverse @ h.T, h @ (before + fall)
        pull = np.zeros(3 * len(self.contacts))
        for c, (_, j, _, gap, _, _) in enumerate(self.contacts):
            q[3 * c] += gap / STEP if gap > 0 else self.e * (h[3 * c] @ before)
            pull[3 * c] = self.pull * STEP if j >= 0 else 0.0
        return h, w, q - w @ pull, pull, inverse, before + fall

    def solve(self):
        """Impulses on the first bodies, one per row, velocities after the step, and whether there is one solution."""
        h, w, q, pull, inverse, free = self.assemble()
        n = len(self.contacts)
        options = sn.SolverOptions(sn.SICONOS_FRICTION_3D_NSGS)
        options.iparam[sn.SICONOS_IPARAM_MAX_ITER] = 1000000
        options.dparam[sn.SICONOS_DPARAM_TOL] = 1e-15
        options.iparam[sn.SICONOS_FRICTION_3D_IPARAM_ERROR_EVALUATION] = sn.SICONOS_FRICTION_3D_NSGS_ERROR_EVALUATION_LIGHT
        r, u = np.zeros(3 * n), np.zeros(3 * n)
        sn.fc3d_driver(sn.FrictionContactProblem(3, np.asfortranarray(w), q, np.full(n, self.mu)), r, u, options)
        left = self.left(w, q, r)
        assert left < 1e-3 * SAME, f"Siconos leaves {left}"
        r = r - pull
        frames = [h[3 * c:3 * c + 3, 6 * i:6 * i + 3] for c, (i, *_) in enumerate(self.contacts)]
        values = np.linalg.eigvalsh(w if self.mu > 0 else w[::3, ::3])
        return [r[3 * c:3 * c + 3] @ f for c, f in enumerate(frames)], (free + inverse * (h.T @ r)).reshape(-1, 6), values[0] > 1e-9 * values[-1]

    def left(self, w, q, r):
        """Of Signorini's and Coulomb's conditions, as a speed, relative to the speeds there are; by their own words, not by a projection."""
        u = (w @ r + q).reshape(-1, 3)
        worst, size = 0.0, max(np.abs(q).max(), np.abs(u).max())
        for (un, *ut), (rn, *rt), weight in zip(u, r.reshape(-1, 3), w.diagonal()[::3]):
            limit, slide, force = self.mu * rn, np.hypot(*ut), np.hypot(*rt)
            worst = max(worst, -un, -rn * weight, min(un, rn * weight), (force - limit) * weight, min(slide, (limit - force) * weight))
            if slide > 1e-6 * size:
                worst = max(worst, weight * np.linalg.norm(np.array(rt) + limit * np.array(ut) / slide))
        return worst / size

    def case(self):
        def vector(v):
            return " ".join(repr(float(x)) for x in v)

        reach = 'plugin="cohesive" ' + f'pull="{self.pull!r} N" distance="0.1 mm"'
        lines = ['<case title="one step" dimension="3">']
        for k, b in enumerate(self.bodies):
            lines.append(f'<material name="m{k}" density="{b.density!r} kg/m3"/>')
        lines += ['<material name="plane"/>', f'<contact plugin="signorini-coulomb" friction="{self.mu!r}" restitution="{self.e!r}"/>',
                  f"<contact {reach}/>" if self.pull else "",
                  f'<integrator plugin="nscd" dt="{STEP!r} s" tolerance="1e-13" accuracy="1e-13" reach="{REACH!r}"/>',
                  f"<gravity>{vector(self.gravity)} m/s2</gravity>"]
        for k, (point, normal) in enumerate(self.planes):
            lines.append(f'<walls name="w{k}" material="plane"><plane point="{vector(point)} m" normal="{vector(normal)}"/></walls>')
        for k, b in enumerate(self.bodies):
            fixed = ' fixed="yes"' if b.fixed else ""
            lines.append(f'<particles material="m{k}"><particle at="{vector(b.at)} m" radius="{b.radius!r} m" velocity="{vector(b.velocity)} m/s" '
                         f'spin="{vector(b.spin)} rad/s"{fixed}/></particles>')
        return "\n".join(lines + [f'<stage for="{STEP!r} s"/>', "</case>"])


def incline(slope, mu):
    """A sphere on a plane, at rest; gravity is turned."""
    g = (GRAVITY * math.sin(slope), 0, -GRAVITY * math.cos(slope))
    return Problem([Body((0, 0, 0.01))], [((0, 0, 0), (0, 0, 1))], mu=mu, gravity=g)


def column(densities):
    return Problem([Body((0, 0, 0.01 + 0.02 * k), density=d) for k, d in enumerate(densities)], [((0, 0, 0), (0, 0, 1))], mu=0.3)


def groove(mu):
    half, s = math.sqrt(0.5), 0.01 * math.sqrt(2)
    return Problem([Body((0, 0, s), velocity=(0, 0.1, 0))], [((0, 0, 0), (half, 0, half)), ((0, 0, 0), (-half, 0, half))], mu=mu)


def pyramid(mu):
    """Three spheres on a floor, apart from each other, and one on top."""
    side, radius = 0.021, 0.01
    height = radius + math.sqrt(4 * radius**2 - side**2 / 3)
    base = [Body((side / math.sqrt(3) * math.cos(a), side / math.sqrt(3) * math.sin(a), radius)) for a in (0.3, 0.3 + 2 * math.pi / 3, 0.3 + 4 * math.pi / 3)]
    return Problem(base + [Body((0, 0, height))], [((0, 0, 0), (0, 0, 1))], mu=mu)


FLOOR = [((0, 0, 0), (0, 0, 1))]


def problems():
    return {
        "a sphere lies on a floor": Problem([Body((0, 0, 0.01))], FLOOR, mu=0.5),
        "a sphere begins to roll down a slope": incline(0.3, 0.5),
        "a sphere begins to slide down a slope": incline(0.8, 0.1),
        "a spinning sphere bounces": Problem([Body((0, 0, 0.01), velocity=(1, 0.3, -1), spin=(20, -50, 10))], FLOOR, mu=0.2, e=0.6),
        "two spheres collide off their line": Problem([Body((0, 0, 0.1), velocity=(1, 0.2, 0)), Body((0.018, 0.008, 0.101), velocity=(-0.5, 0, 0.3), radius=0.012,
                                                      density=7800.0)], mu=0.3, e=0.7, gravity=AT_REST),
        "a column of five": column([2500.0] * 5),
        "heavy on light": column([100.0, 100000.0]),
        "a sphere slides along a groove": groove(0.1),
        "three and one on top": pyramid(0.05),
        "one hangs from another that holds it": Problem([Body((0, 0, 0.1), fixed=True), Body((0, 0, 0.08))], pull=1.0, mu=0.3),
    }


@unittest.skipIf(sn is None, "python3-siconos is not installed")
class OneStep(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="calx-rigid-")

    def tearDown(self):
        for name in os.listdir(self.folder):
            os.remove(os.path.join(self.folder, name))
        os.rmdir(self.folder)

    def calx(self, problem):
        path = os.path.join(self.folder, "case.xml")
        with open(path, "w", encoding="ascii") as file:
            file.write(problem.case())
        return json.loads(subprocess.run([TOOL, "show", path], stdout=subprocess.PIPE, text=True, check=True, timeout=60).stdout)

    def compare_impulses(self, problem, expected, contacts):
        self.assertEqual(len(contacts), len(expected))
        size = max(np.linalg.norm(r) for r in expected)
        for (i, j, normal, *_), r in zip(problem.contacts, expected):
            found = [c for c in contacts if {c["i"], c["j"]} == {i, j} and abs(np.array(c["normal"]) @ normal) > 1 - 1e-9]
            self.assertEqual(len(found), 1, f"contact of {i} and {j}")
            sign = 1 if found[0]["i"] == i else -1
            self.assertLess(np.linalg.norm(sign * np.array(found[0]["impulse"]) - r), SAME * size, f"{i}, {j}: {found[0]['impulse']}, not {r}")

    def test_ten_problems(self):
        unique = 0
        self.assertEqual(len(problems()), 10)
        for name, problem in problems().items():
            with self.subTest(name):
                impulses, velocities, one = problem.solve()
                ours = self.calx(problem)
                if one:
                    self.compare_impulses(problem, impulses, ours["contacts"])
                unique += one
                # What rolls has the speed of its surface: spins count by the radius. A step of gravity is the least that speeds are measured by.
                scale = np.array([[1, 1, 1, b.radius, b.radius, b.radius] for b in problem.bodies])
                found = np.array([ours["bodies"][str(k)] for k in range(len(problem.bodies))])
                size = max(np.abs(scale * velocities).max(), STEP * GRAVITY)
                self.assertLess(np.abs(scale * (found - velocities)).max(), SAME * size, f"{found}, not {velocities}")
        self.assertGreaterEqual(unique, 8)


if __name__ == "__main__":
    unittest.main(verbosity=2)
