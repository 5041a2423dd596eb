#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every kernel of every contact law and conductance is a loop that the compiler reports as vectorised, for each instruction set; and a
law built by the one command of plugins/README.md needs the instructions of the one built by meson.

The build folder is $CALX_BUILD, the sources are in $CALX_SOURCE_ROOT."""

import glob
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.abspath(os.environ.get("CALX_SOURCE_ROOT", os.path.dirname(HERE)))
BUILD = os.environ.get("CALX_BUILD", os.path.join(ROOT, "build"))
sys.dont_write_bytecode = True
sys.path.insert(0, HERE)
import test_instructions  # noqa: E402

# What gcc is asked, what a line of its answer looks like, and the widths of vectors to be found, in bytes: those of the instruction sets for
# which CALX_KERNEL compiles.
TELL, TOLD = "-fopt-info-vec-optimized", r":(\d+):\d+: optimized: loop vectorized using (\d+) byte"
WIDTHS = {16, 32, 64}
LOOP = re.compile(r"^ +for \(size_t \w+ = 0; \w+ < (b->)?n; \w+\+\+\)")
FUNCTION = re.compile(r"^(?:CALX_KERNEL )?static (?:inline __attribute__\(\(always_inline\)\) )?[\w ]*?(\w+)\(")
# Functions that no step calls; what a non-smooth law says once, before its contacts are solved in many sweeps.
NOW_AND_THEN = {"response", "condition"}
# Another build of the same loop: the compiler may order it differently, and may not lose a vector or a check of aliasing.
SAME = 0.10


def sources():
    """Of laws that exert forces, or conduct."""
    names = glob.glob(os.path.join(ROOT, "plugins", "contact-*.c"))
    names = [n for n in names if ".nonsmooth = 1" not in open(n, encoding="utf-8").read()] + glob.glob(os.path.join(ROOT, "plugins", "conductance-*.c"))
    return sorted(names) + [os.path.join(ROOT, "plugins", "template-contact.c")]


def kernel_loops(path):
    """Lines of the loops over contacts that a step runs, with their functions."""
    found, function = {}, ""
    with open(path, encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            match = FUNCTION.match(line)
            function = match.group(1) if match else function
            if LOOP.match(line) and function not in NOW_AND_THEN:
                found[number] = function
    return found


def project_command(path):
    """The command by which meson compiles the file, without its output, and the folder for it."""
    with open(os.path.join(BUILD, "compile_commands.json"), encoding="utf-8") as file:
        entry = next(e for e in json.load(file) if os.path.samefile(os.path.join(e["directory"], e["file"]), path))
    words = shlex.split(entry["command"])
    for option in ("-o", "-MQ", "-MF"):
        at = words.index(option)
        del words[at:at + 2]
    return [w for w in words if w not in ("-MD", "-fdiagnostics-color=always")], entry["directory"]


def vectorised(words, folder):
    """Widths by line."""
    done = subprocess.run(words + [TELL, "-o", os.devnull], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stdout
    widths = {}
    for line, width in re.findall(TOLD, done.stdout):
        widths.setdefault(int(line), set()).add(int(width))
    return widths


def readme_command(path, out):
    """The command of plugins/README.md for that file."""
    with open(os.path.join(ROOT, "plugins", "README.md"), encoding="utf-8") as file:
        text = re.search(r"`(cc [^`]* contact-NAME\.c [^`]*)`", file.read()).group(1)
    words = [{"SOURCE": ROOT, "contact-NAME.c": path, "contact-NAME.so": out}.get(w, w) for w in shlex.split(text)]
    assert path in words and out in words and ROOT in words, text
    return words


class Report(unittest.TestCase):
    def test_each_kernel_is_a_vectorised_loop(self):
        for path in sources():
            loops = kernel_loops(path)
            widths = vectorised(*project_command(path))
            self.assertTrue(loops, f"{path}: no kernel found")
            for line, function in loops.items():
                with self.subTest(loop=f"{os.path.relpath(path, ROOT)}:{line}", function=function):
                    self.assertLessEqual(WIDTHS, widths.get(line, set()), "not vectorised for all of these widths")

    def test_a_scalar_loop_is_found(self):
        """The same file without the compiler's vectoriser: the test above would fail."""
        words, folder = project_command(os.path.join(ROOT, "plugins", "contact-linear.c"))
        self.assertEqual(vectorised(words + ["-fno-tree-vectorize"], folder), {})


@unittest.skipUnless(shutil.which("valgrind"), "valgrind is not installed")
class PlainBuild(unittest.TestCase):
    def test_one_command_gives_the_same_speed(self):
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        with tempfile.TemporaryDirectory(prefix="calx-plain-") as folder:
            plain, meson = [], []
            for path in sources():
                name = os.path.basename(path)[:-2]
                name = "contact-template" if name == "template-contact" else name
                meson.append(os.path.join(BUILD, "plugins", name + ".so"))
                plain.append(os.path.join(folder, name + ".so"))
                subprocess.run(readme_command(path, plain[-1]), check=True, timeout=120)
            ours = test_instructions.count_kernels(meson, environment)
            theirs = test_instructions.count_kernels(plain, environment)
        self.assertEqual(ours.keys(), theirs.keys())
        slower = [f"{name}: {theirs[name]:.4g} instructions, by meson {figure:.4g}" for name, figure in ours.items()
                  if abs(theirs[name] / figure - 1) > SAME]
        self.assertEqual(slower, [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
