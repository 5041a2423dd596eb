#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Points of other codes in a report: their file is read, and its mistakes are told with their line; and, where they are installed, LAMMPS and
LIGGGHTS take the same steps through the collisions of cases/accuracy as calx with velocity Verlet.

The program is $CALX_PROGRAM, its plugins are in $CALX_PLUGINS, the sources in $CALX_SOURCE_ROOT."""

import csv
import glob
import importlib.machinery
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.abspath(os.environ.get("CALX_SOURCE_ROOT", "."))
PROGRAM = os.environ.get("CALX_PROGRAM", os.path.join(ROOT, "build", "io", "calx"))
LINEAR = os.path.join(ROOT, "cases", "accuracy", "linear.xml")
WORDS = ["--integrators", "velocity-verlet", "--steps", "2e-6..8e-6", "--quantity", "rebound,height", "--budget", "60s", "--threads", "1", "--quiet"]
HEADER = "name,dt,error,seconds,evaluations,quantity\n"


def load_peers():
    """tests/peers, a program whose name has no ending."""
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader("peers", os.path.join(ROOT, "tests", "peers"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("peers", loader))
    loader.exec_module(module)
    return module


class InFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="calx-peers-")
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, *parts):
        return os.path.join(self.folder, *parts)


class Points(InFolder):
    MISTAKES = [
        ("", "empty"), ("name,dt\n", "error"), ("name,dt,error,colour\n", "colour"), ("name,dt,error,dt\n", "each once"),
        (HEADER + "x,1e-6,1e-3,,\n", "line 2: fewer"), (HEADER + "x,1e-6,1e-3,,,,\n", "line 2: more"),
        (HEADER + "x,0,1e-3,,,\n", "dt must be"), (HEADER + "x,1e-6,-1,,,\n", "-1"), (HEADER + "x,1e-6,nan,,,\n", "nan"),
        (HEADER + "x,1e-6,1e-3,,,\nx,1e-6,1 %,,,\n", "line 3"), (HEADER + ",1e-6,1e-3,,,\n", "1 to 63"),
        (HEADER + 'a"b,1e-6,1e-3,,,\n', "1 to 63"), (HEADER + "x,1e-6,1e-3,,,reboudn\n", "rebound"),
    ]

    def report(self, text, *more):
        with open(self.path("points.csv"), "w", encoding="utf-8") as file:
            file.write(text)
        return subprocess.run([PROGRAM, "report", LINEAR, *WORDS, *more, "--out", self.path("out"), "--points", self.path("points.csv")],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=600)

    def test_mistakes_name_file_and_line(self):
        for text, says in self.MISTAKES:
            with self.subTest(text=text):
                done = self.report(text)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(says, done.stderr)
                self.assertIn("points.csv", done.stderr)
        done = subprocess.run([PROGRAM, "report", LINEAR, *WORDS, "--out", self.path("out"), "--points", self.path("none")],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=600)
        self.assertEqual(done.returncode, 2)

    def test_they_join_table_page_picture_and_json(self):
        done = self.report(HEADER.replace("quantity", " quantity ") + "Code A,5e-6,1.5e-4,1e-4,120,\n\nCode A,2.5e-6,4e-5,,,rebound\n"
                           "Code B,5e-6,1e-6,1e-4,240,height\n", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        report = json.loads(done.stdout)
        self.assertEqual([(p["name"], p["quantity"], p["dt"], p["error"], p["evaluations"]) for p in report["peers"]],
                         [("Code A", "rebound", 5e-6, 1.5e-4, 120), ("Code A", "rebound", 2.5e-6, 4e-5, None), ("Code B", "height", 5e-6, 1e-6, 240)])
        with open(self.path("out", "report.csv"), encoding="ascii") as file:
            rows = [row for row in csv.DictReader(file) if row["status"] == "peer"]
        self.assertEqual([(row["integrator"], row["error rebound"], row["error height"]) for row in rows],
                         [("Code A", "0.00014999999999999999", ""), ("Code A", "4.0000000000000003e-05", ""), ("Code B", "", "9.9999999999999995e-07")])
        with open(self.path("out", "report.md"), encoding="utf-8") as file:
            page = file.read()
        self.assertIn("| Code A | 5 us | 0.015 % | 120 | 100 us |", page)
        self.assertIn("| Code A | 2.5 us | 4.0e-05 | - | - |", page)
        with open(self.path("out", "report.gp"), encoding="utf-8") as file:
            script = file.read()
        self.assertIn('title "Code A"', script)
        self.assertIn("0.0001 0.00015\n", script)
        self.assertNotIn("peer", report["verdicts"][0]["text"])


class SameSteps(InFolder):
    # The same arithmetic in another order: an overlap, 1/40 of the position, carries 40 roundings of 1.1e-16, and each of some 200 steps adds as many
    # to the velocity.
    SAME = 200 * 40 * 1.1e-16

    def ours(self, name, dt, quantity):
        folder = tempfile.mkdtemp(dir=self.folder)
        subprocess.run([PROGRAM, "run", os.path.join(ROOT, "cases", "accuracy", name + ".xml"), "--quiet", "--threads", "1", "--set",
                        f"integrator/dt={dt!r} s", "--out", folder], check=True, stdout=subprocess.DEVNULL, timeout=600)
        (table,) = glob.glob(os.path.join(folder, "*.csv"))
        with open(table, encoding="ascii") as file:
            last = list(csv.DictReader(file))[-1]
        return float(next(value for key, value in last.items() if key.split(" ")[0] == quantity))

    def check_code(self, code):
        peers = load_peers()
        if not shutil.which(peers.CODES[code][0]):
            self.skipTest(f"{peers.CODES[code][0]} is not installed (package {peers.CODES[code][1]})")
        for name, case in peers.CASES.items():
            steps = [case["end"] / 105, case["end"] / 199]
            velocities, loops = peers.run(code, case, steps, self.folder)
            self.assertEqual(len(loops), len(steps))
            for dt, velocity in zip(steps, velocities):
                with self.subTest(case=name, dt=dt):
                    theirs = velocity[0 if case["quantity"] == "along" else 1]
                    self.assertAlmostEqual(theirs / self.ours(name, dt, case["quantity"]), 1, delta=self.SAME)

    def test_lammps(self):
        self.check_code("LAMMPS")

    def test_liggghts(self):
        self.check_code("LIGGGHTS")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
