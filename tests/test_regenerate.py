#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The scripts that write the reports of cases/accuracy and the tables of cases/collisions, with a small budget and into another folder: they
run through, and what they write has the form of what is in the repository.

The program is $CALX_PROGRAM, its plugins are in $CALX_PLUGINS, the sources in $CALX_SOURCE_ROOT."""

import os
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = os.path.abspath(os.environ.get("CALX_SOURCE_ROOT", "."))
CASES = os.path.join(ROOT, "cases")


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


class Regenerate(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="calx-regenerate-")
        self.addCleanup(shutil.rmtree, self.folder)
        self.before = subprocess.run(["ls", "-lR", "--time-style=full-iso", CASES], stdout=subprocess.PIPE, check=True).stdout

    def run_script(self, folder, *words):
        done = subprocess.run([os.path.join(CASES, folder, "regenerate"), "--budget", "3s", *words], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=900)
        self.assertEqual(done.returncode, 0, done.stdout)
        after = subprocess.run(["ls", "-lR", "--time-style=full-iso", CASES], stdout=subprocess.PIPE, check=True).stdout
        self.assertEqual(after, self.before)  # nothing in the repository was touched
        return done.stdout

    @unittest.skipUnless(shutil.which("gnuplot"), "gnuplot is not installed")
    def test_accuracy(self):
        said = self.run_script("accuracy", "--out", self.folder, "linear", "conduction-pair")
        self.assertIn("== linear\nFor 0.1 % in rebound use ", said)
        self.assertEqual(sorted(os.listdir(self.folder)), ["conduction-pair.md", "conduction-pair.svg", "linear.md", "linear.svg", "stability.md",
                                                           "stability.svg"])
        for name in ("linear", "conduction-pair", "stability"):
            page = read(os.path.join(self.folder, name + ".md"))
            self.assertIn(f"]({name}.svg)", page)
            self.assertNotIn(".png", page)
            self.assertEqual(page.splitlines()[0], read(os.path.join(CASES, "accuracy", "reports", name + ".md")).splitlines()[0])

    def test_collisions(self):
        readme = os.path.join(self.folder, "README.md")
        shutil.copy(os.path.join(CASES, "collisions", "README.md"), readme)
        old = read(readme)
        self.run_script("collisions", "--readme", readme, "pair")
        new = read(readme)
        outside = [re.sub(r"(?s)<!-- pair -->.*<!-- end of pair -->", "", text) for text in (old, new)]
        self.assertEqual(*outside)
        lines = re.search(r"(?s)<!-- pair -->\n(.*)<!-- end of pair -->", new).group(1).splitlines()
        self.assertEqual(lines[0], re.search(r"<!-- pair -->\n(.*)\n", old).group(1))
        self.assertIn("velocity-verlet", [line.split("|")[1].strip() for line in lines[2:]])
        self.assertEqual({line.count("|") for line in lines}, {lines[0].count("|")})


if __name__ == "__main__":
    unittest.main(verbosity=1)
