# SPDX-License-Identifier: BSD-3-Clause
"""Runs a program under valgrind's callgrind and reads what it counted: instructions, which no other load on the machine disturbs."""

import glob
import os
import re
import subprocess
import tempfile
from collections import namedtuple

# A call: object file and function of caller and callee, how often, and the instructions of the callee with all that it called.
Call = namedtuple("Call", "caller_object caller callee_object callee count instructions")
# Of `calx bench`, the step loop alone: the second part is that of the timed steps, for calx_sim_timing is asked before and after them.
STEP_LOOP = ["--toggle-collect=calx_sim_advance", "--toggle-collect=calx_sim_step", "--dump-before=calx_sim_timing"]
# What was counted between two dumps.
Part = namedtuple("Part", "total calls")


def read_part(path):
    """Names are written out (--compress-strings=no); a line of a callee (cob=, cfn=) holds until the calls= line it belongs to."""
    calls, total = [], 0
    here = {"ob": "", "fn": ""}
    callee = {}
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            key, _, value = line.rstrip("\n").partition("=")
            if key in here:
                here[key] = value
            elif key in ("cob", "cfn"):
                callee[key] = value
            elif key == "calls":
                cost = next(file).split()
                calls.append(Call(here["ob"], here["fn"], callee.get("cob", here["ob"]), callee["cfn"], int(value.split()[0]),
                                  int(cost[1])))
                callee = {}
            elif line.startswith("totals:"):
                total = int(line.split()[1])
    return Part(total, calls)


def run(command, options, environment, timeout=600):
    """What the program printed, and its parts in the order of the dumps; the last is that of the program's end. `meson test` has malloc
    fill what it gives and takes (MALLOC_PERTURB_), which would count."""
    environment = {name: value for name, value in environment.items() if not name.startswith("MALLOC_")}
    with tempfile.TemporaryDirectory(prefix="calx-callgrind-") as folder:
        out = os.path.join(folder, "out")
        done = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=" + out, "--compress-strings=no",
                               "--compress-pos=no", *options, *command], env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=timeout, check=False)
        if done.returncode:
            raise RuntimeError(f"{' '.join(command)} under valgrind: status {done.returncode}\n{done.stderr}")
        paths = sorted(glob.glob(out + ".*"), key=lambda p: int(re.search(r"\d+$", p).group()))
        return done.stdout, [read_part(path) for path in paths + [out]]
