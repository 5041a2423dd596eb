#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""`calx bench`: what it refuses, what it reports, and that the benchmark's cases can be read and run. No test asserts a time.

The program is $CALX_PROGRAM, its plugins are in $CALX_PLUGINS, the sources in $CALX_SOURCE_ROOT."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.abspath(os.environ.get("CALX_SOURCE_ROOT", "."))
PROGRAM = os.environ.get("CALX_PROGRAM", os.path.join(ROOT, "build", "io", "calx"))
SCENES = os.path.join(ROOT, "tests", "bench")
SMALL = ["--set", "particles/pack/count=300", "--set", "particles/pack/box=0 0 0 0.012 0.012 0.02",
         "--set", "domain/high=0.012 0.012 0.2"]
WARM, STEPS = 700, 60
LAPS = STEPS // 5
ROUNDING = 1e-4  # shares are printed with six digits, and there are thirteen of them


def calx(*words, **options):
    return subprocess.run([PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300,
                          **options)


def bench(*words):
    done = calx("bench", *words, "--json", "--warm", str(WARM), "--steps", str(STEPS))
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


class Usage(unittest.TestCase):
    REFUSED = [
        (["--threads", ""], "whole numbers"), (["--threads", "0"], "whole numbers"),
        (["--threads", "1,"], "whole numbers"), (["--threads", ",2"], "whole numbers"),
        (["--threads", "1;2"], "whole numbers"), (["--threads", "1,1025"], "from 1 to 1024"),
        (["--threads", ",".join("1" * 17)], "up to 16"),
        (["--steps", "0"], "from 1"), (["--steps", "-5"], "from 1"), (["--steps", "1e3"], "whole number"),
        (["--steps", "99999999999999999999"], "whole number"),
        (["--warm", "-1"], "from 0"), (["--warm", "x"], "whole number"),
        (["--out", "x"], "no option"), (["nowhere.xml"], "nowhere.xml"), (["a.xml", "b.xml"], "too many"),
        (["--set", "particles/pack/cuont=3"], "count"),
        ([os.path.join(ROOT, "cases", "04-two-spheres"), "--steps", "1000000000"], "the case ends after"),
    ]

    def test_mistakes_are_refused(self):
        for words, says in self.REFUSED:
            with self.subTest(words=words):
                done = calx("bench", *words)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(says, done.stderr)
                self.assertEqual(done.stdout, "")

    def test_no_file_is_left(self):
        folder = tempfile.mkdtemp(prefix="calx-bench-")
        self.addCleanup(shutil.rmtree, folder)
        for extra in ([], ["--set", "particles/pack/radius=-1"]):
            calx("bench", *SMALL, "--warm", "0", "--steps", "1", *extra, cwd=folder, env={**os.environ, "TMPDIR": folder})
            self.assertEqual(os.listdir(folder), [])


class Report(unittest.TestCase):
    def test_one_object_per_number_of_threads(self):
        runs = bench(*SMALL, "--threads", "1,2")
        self.assertEqual([r["threads"] for r in runs], [1, 2])
        self.assertEqual(runs[0]["hash"], runs[1]["hash"])
        for run in runs:
            self.assertEqual((run["case"], run["particles"], run["warm"], run["steps"]), ("made bed", 300, WARM, STEPS))
            self.assertAlmostEqual(sum(run["shares"].values()), 1, delta=ROUNDING)
            self.assertLessEqual(run["laws"]["linear"] + run["laws"]["coulomb"], run["shares"]["laws"] + ROUNDING)
            for phase in ("gather", "laws", "scatter", "integrate"):
                self.assertGreater(run["shares"][phase], 0)
            speed = run["particles"] * run["steps"] / run["seconds"]
            self.assertAlmostEqual(run["particle_steps_per_second"] / speed, 1, delta=1e-6)
            for quantity in ("contacts", "pairs_per_particle", "bytes_per_particle", "resident_bytes",
                             "bytes_moved_per_particle_step", "memory_bytes_per_second", "cache_bytes_per_second"):
                self.assertGreater(run[quantity], 0, quantity)
            self.assertAlmostEqual(run["bytes"] / run["particles"], run["bytes_per_particle"], delta=1e-3)

    def test_the_state_is_that_after_the_steps(self):
        short = bench(*SMALL, "--threads", "1")[0]
        split = calx("bench", *SMALL, "--json", "--threads", "1", "--warm", str(WARM + STEPS - 1), "--steps", "1")
        self.assertEqual(json.loads(split.stdout)["hash"], short["hash"])

    def test_fewer_threads_than_asked_for(self):
        """The system may give fewer: what the others would have done is done all the same, with the same bits."""
        several_blocks = ["--set", "particles/pack/count=5000", "--json", "--warm", "50", "--steps", "50", "--threads", "3"]
        hashes = set()
        for limit in ("1", "3"):
            done = calx("bench", *several_blocks, env={**os.environ, "OMP_THREAD_LIMIT": limit})
            self.assertEqual(done.returncode, 0, done.stderr)
            hashes.add(json.loads(done.stdout)["hash"])
        self.assertEqual(len(hashes), 1)

    def test_a_scene_without_search_is_json_too(self):
        done = calx("bench", os.path.join(ROOT, "cases", "01-bounce"), "--json", "--threads", "1", "--warm", "0", "--steps", "10")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(json.loads(done.stdout, parse_constant=self.fail)["particle_steps_per_second"], 0)

    def test_text_says_the_same(self):
        done = calx("bench", *SMALL, "--threads", "1", "--warm", str(WARM), "--steps", str(STEPS))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("300 particles, 1 thread", done.stdout)
        self.assertIn(f"over {LAPS} steps with laps", done.stdout)
        shares = [float(x) for x in re.findall(r"^    [a-z]\S* +([0-9.]+) %", done.stdout, re.M)]
        self.assertAlmostEqual(sum(shares), 100, delta=0.05 * len(shares))
        self.assertEqual(re.search(r"state hash: ([0-9a-f]{16})", done.stdout).group(1),
                         bench(*SMALL, "--threads", "1")[0]["hash"])


class Scenes(unittest.TestCase):
    # A tower of four grains: their radius, the lowest one, which touches the wall if there is one, and the way up.
    GRAINS = {"s1": (2e-3, (0, -0.07425, 0.02), 1), "s1h": (2e-3, (0, -0.07425, 0.02), 1),
              "s2": (1e-3, (0.05, 0.05, 0.00099), 2), "s3": (1e-3, (0.05, 0.05, 0.00099), 2),
              "s4": (1e-3, (0.05, 0.05, 0.2), 2), "s5": (2e-3, (0, -0.04805, 0), 1)}

    def test_every_scene_runs(self):
        folder = tempfile.mkdtemp(prefix="calx-bench-")
        self.addCleanup(shutil.rmtree, folder)
        plugins = os.environ.get("CALX_PLUGINS", "")
        self.assertEqual(sorted(self.GRAINS), sorted(n for n in os.listdir(SCENES) if re.match(r"s\d", n)))
        for name, (radius, lowest, up) in self.GRAINS.items():
            with self.subTest(scene=name), open(os.path.join(folder, name + ".csv"), "w", encoding="ascii") as csv:
                csv.write("x,y,z,radius,vx,vy,vz\n")
                for k in range(4):
                    centre = [x + (1.99 * radius * k if axis == up else 0) for axis, x in enumerate(lowest)]
                    csv.write("{},{},{},{},0,0,0\n".format(*centre, radius))
                csv.flush()
                done = calx("bench", os.path.join(SCENES, name), "--set", "particles/csv/file=" + csv.name, "--steps",
                            "20", "--warm", "0", "--threads", "1", "--json", env={**os.environ, "CALX_PLUGINS": plugins})
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertGreaterEqual(json.loads(done.stdout)["contacts"], 3)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
