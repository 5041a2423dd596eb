# SPDX-License-Identifier: BSD-3-Clause
"""A contact problem that contact_problem has written, assembled anew: W r + q = u with r and u in frames of the contacts (normal, two
tangents), and what a solution leaves of De Saxce's natural map, the measure of calx (plugins/nscd-solve.c), computed here a second time."""

import numpy as np
from scipy import sparse


class Problem:
    def __init__(self, path):
        with open(path, "rb") as file:
            self.n, rows = (int(k) for k in np.fromfile(file, np.int64, 2))
            self.dt = np.fromfile(file, float, 1)[0]
            velocity = np.fromfile(file, float, 8 * rows).reshape(rows, 8)
            np.fromfile(file, float, 4 * rows)  # positions
            self.normal = np.fromfile(file, float, 3 * self.n).reshape(3, self.n).T
            self.lever = np.fromfile(file, float, 2 * self.n).reshape(2, self.n)
            gap, self.mu = np.fromfile(file, float, 2 * self.n).reshape(2, self.n)
            body = np.fromfile(file, np.int32, 2 * self.n).reshape(2, self.n)
        self.frame = self._frames()
        h = self._velocity_of(body, rows)
        inverse = np.repeat(velocity[:, [3, 7]], 3, axis=1)  # 1/m three times, 1/I three times
        self.w = (h @ sparse.diags(inverse.ravel()) @ h.T).tocsr()
        self.q = h @ np.concatenate([velocity[:, :3], velocity[:, 4:7]], axis=1).ravel()
        self.q[::3] += np.maximum(gap, 0) / self.dt  # what is apart may approach

    def _frames(self):
        """[contact, direction, component]"""
        aside = np.where(np.abs(self.normal[:, [0]]) < 0.7, [[1.0, 0, 0]], [[0, 1.0, 0]])
        first = np.cross(self.normal, aside)
        first /= np.linalg.norm(first, axis=1)[:, None]
        return np.stack([self.normal, first, np.cross(self.normal, first)], axis=1)

    def _velocity_of(self, body, rows):
        """From velocities and spins of bodies to relative velocities: of a contact at -l_i n from the centre of i, l_j n from that of j,
        v_i - v_j + n x (l_i w_i + l_j w_j)."""
        parts = []
        for b, sign in ((0, 1.0), (1, -1.0)):
            there = np.nonzero(body[b] >= 0)[0]
            for direction in range(3):
                turned = np.cross(self.frame[there, direction], self.normal[there]) * self.lever[b, there, None]
                row = np.repeat(3 * there + direction, 6)
                column = (6 * body[b, there, None] + np.arange(6)).ravel()
                parts.append((row, column, np.concatenate([sign * self.frame[there, direction], turned], axis=1).ravel()))
        row, column, value = (np.concatenate(p) for p in zip(*parts))
        return sparse.csr_matrix((value, (row, column)), shape=(3 * self.n, 6 * rows))

    def impulses(self, path):
        """Those that contact_problem has written: a normal part and a vector."""
        r = np.fromfile(path, float, 4 * self.n).reshape(4, self.n)
        local = np.einsum("ndc,cn->nd", self.frame, r[1:])
        local[:, 0] = r[0]
        return local.ravel()

    def residual(self, r):
        """|r - P(r - (u + mu |u_t| n)/w_n)| over |r|, P the projection on the cones |r_t| <= mu r_n."""
        u, at = (self.w @ r + self.q).reshape(-1, 3), r.reshape(-1, 3)
        weight = self.w.diagonal()[::3]
        z = at[:, 0] - (u[:, 0] + self.mu * np.linalg.norm(u[:, 1:], axis=1)) / weight
        t = at[:, 1:] - u[:, 1:] / weight[:, None]
        size = np.linalg.norm(t, axis=1)
        inside, polar = size <= self.mu * z, self.mu * size <= -z
        on = (z + self.mu * size) / (1 + self.mu**2)
        normal = np.where(inside, z, np.where(polar, 0, on))
        share = np.where(inside, 1, np.where(polar, 0, self.mu * on / np.where(size > 0, size, 1)))
        left = np.concatenate([(at[:, 0] - normal)[:, None], at[:, 1:] - share[:, None] * t], axis=1)
        return np.linalg.norm(left) / np.linalg.norm(r)
