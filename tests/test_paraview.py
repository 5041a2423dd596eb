#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""ParaView opens what calx writes: whole results, and those of runs that were killed.

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
        shutil.rmtree(self.folder)

    def words(self, name, *more):
        return [PROGRAM, "run", os.path.join(DATA, name + ".xml"), "--quiet", "--threads", "1", "--out", self.folder, *more]

    def check(self, name, particles, *more):
        case = os.path.join(DATA, name + ".xml")
        done = subprocess.run(["pvpython", CHECK, self.folder, name, "--case", case, "--particles", str(particles),
                               "--network", *more], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
        failed = [line for line in done.stdout.splitlines() if not line.startswith("PASS")]
        self.assertEqual(done.returncode, 0, "\n".join(failed))
        self.assertIn("all checks passed", done.stdout)

    def test_hot_discs_in_a_drum(self):
        subprocess.run(self.words("drum", "--set", "output/every=20 ms"), check=True, timeout=300)
        self.check("drum", 60)

    def test_cold_spheres_in_a_pot(self):
        subprocess.run(self.words("spheres"), check=True, timeout=300)
        self.check("spheres", 200)

    def test_killed_runs(self):
        chance = random.Random(1)
        for kill in range(KILLS):
            with self.subTest(kill=kill):
                with subprocess.Popen(self.words("drum")) as run:
                    while not os.path.exists(os.path.join(self.folder, "drum_000004.vtu")) and run.poll() is None:
                        time.sleep(0.001)
                    time.sleep(chance.uniform(0, 0.1))
                    run.kill()
                self.check("drum", 60)
                shutil.rmtree(self.folder)


if __name__ == "__main__":
    unittest.main(argv=sys.argv, verbosity=2)
