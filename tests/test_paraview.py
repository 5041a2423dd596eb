#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""ParaView opens raw 32-bit output, and what is left of runs that were killed.

The checks are tests/paraview/check_series.py, run by pvpython; here are the runs they look at."""

import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = os.path.abspath(os.environ.get("CALX_SOURCE_ROOT", "."))
PROGRAM = os.environ.get("CALX_PROGRAM", os.path.join(ROOT, "build", "io", "calx"))
DATA = os.path.join(ROOT, "tests", "data", "cli")
CHECK = os.path.join(ROOT, "tests", "paraview", "check_series.py")
KILLS = 3


class Opens(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="calx-paraview-")

    def tearDown(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def words(self, name):
        case = os.path.join(DATA, name + ".xml")
        return [PROGRAM, "run", case, "--quiet", "--threads", "1", "--out", self.folder]

    def failures(self, name, particles):
        case = os.path.join(DATA, name + ".xml")
        done = subprocess.run(["pvpython", CHECK, self.folder, name, "--case", case, "--particles", str(particles), "--network"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
        self.assertRegex(done.stdout, "all checks passed|checks failed")  # it came to its end
        return [line for line in done.stdout.splitlines() if line.startswith("FAIL")]

    def test_cold_spheres_in_a_pot(self):
        subprocess.run(self.words("spheres"), check=True, timeout=300)
        self.assertEqual(self.failures("spheres", 200), [])

    def test_killed_runs(self):
        chance = random.Random(1)
        for kill in range(KILLS):
            with self.subTest(kill=kill):
                shutil.rmtree(self.folder)
                with subprocess.Popen(self.words("drum")) as run:
                    while not os.path.exists(os.path.join(self.folder, "drum_000004.vtu")) and run.poll() is None:
                        time.sleep(0.001)
                    time.sleep(chance.uniform(0, 0.1))
                    run.kill()
                # killed between two .pvd files: walls or contacts may lack the last frame, and nothing else may be wrong
                self.assertEqual([line for line in self.failures("drum", 60) if "the times of the grains" not in line], [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv, verbosity=2)
