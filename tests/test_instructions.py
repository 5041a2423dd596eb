#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Instructions per particle-step of each scene of tests/bench, made small, and per contact, particle or body of each kernel of each
plugin, within 3 % of tests/data/instructions.json. Less is a failure too: the figures would guard nothing. `--store` writes the file anew.

Counted by callgrind, which has AVX2 at most, in the step loop alone. A count does not depend on the machine or its load, but on
compiler and libc, so their versions stand with the figures."""

import argparse
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.dont_write_bytecode = True
sys.path[:0] = [HERE, os.path.join(HERE, "bench")]
import callgrind  # noqa: E402
import states  # noqa: E402

STORED = os.path.join(HERE, "data", "instructions.json")
PROGRAM, KERNELS = os.environ.get("CALX_PROGRAM", ""), os.environ.get("CALX_KERNELS", "")
COMPILER = os.environ.get("CALX_COMPILER", "unknown")  # its name and version
BOUND = 0.03
# With another version of gcc (12 or later: older ones do not compile calx), libc or valgrind. Of the 14 kernels that gcc 11 does compile, 13
# come out within 8 % of those of gcc 12; twice that. What loses its vectors changes by half or more.
OTHER_VERSION = 0.15
WARM = 40  # steps after which contacts have their history
SKIPPED = 77
# Their work is that of a library, which may not be there.
ELSEWHERE = {"motion-arkode.so", "temperature-cvode.so"}

# Made small: about 2000 grains in the same density, except s5, which is small already; and how many steps are counted.
SMALL = {
    "s1": (["particles/pack/count=2000", "particles/pack/cylinder=0 0 0.00625 76.2 0 mm", "domain/high=0.1 0.1 0.0125",
            "stage[settle]/for=45 ms", "stage[turn]/for=45 ms"], ["domain/high=0.1 0.1 0.0125"], 120),
    "s2": (["particles/pack/count=1960", "particles/pack/box=0 0 0 0.014 0.014 0.0755", "domain/high=0.014 0.014 0.2"],
           ["domain/high=0.014 0.014 0.2"], 80),
    "s3": (["particles/pack/count=1960", "particles/pack/box=0 0 0 0.014 0.014 0.0755", "domain/high=0.014 0.014 0.2"],
           ["domain/high=0.014 0.014 0.2"], 80),
    "s4": (["particles/pack/count=2000", "particles/pack/box=0 0 0 0.05513 0.05513 0.05513",
            "domain/high=0.05513 0.05513 0.05513"], ["domain/high=0.05513 0.05513 0.05513"], 200),
    "s5": (["stage[turn]/for=0.2 s"], [], 1500),
}
SMALL["s1h"] = SMALL["s1"]


def settings(words):
    return [x for word in words for x in ("--set", word)]


def count_scene(scene, folder, environment):
    """The kernels that calx picked, and instructions per particle-step: without building the neighbour list, and per particle of each
    list built."""
    made, run, steps = SMALL[scene]
    state = os.path.join(folder, scene.removesuffix("h") + ".csv")
    if not os.path.exists(state):
        states.write(states.make(scene.removesuffix("h"), PROGRAM, environment, folder, settings(made)), state)
    text, parts = callgrind.run(
        [PROGRAM, "bench", os.path.join(HERE, "bench", scene), *settings(["particles/csv/file=" + state] + run), "--threads", "1",
         "--warm", str(WARM), "--steps", str(steps), "--json"],
        callgrind.STEP_LOOP, environment)
    record = json.loads(text)
    timed = parts[1]
    spent = sum(c.instructions for c in timed.calls if c.callee == "calx_neighbours_build")
    lists = record["rebuilds"]  # callgrind's number of calls has the one before the steps too, which it was not to collect
    assert (lists > 0) == (spent > 0), (scene, lists, spent)
    grains = record["particles"]
    found = {scene + ", step": (timed.total - spent) / grains / steps}
    if lists:
        found[scene + ", list"] = spent / grains / lists
    return record["kernels"], found


def count_kernels(files, environment):
    """By plugin and choice of parameters: instructions per contact, particle or body, in the plugin and what it calls."""
    text, parts = callgrind.run([KERNELS, *files], ["--toggle-collect=drive", "--dump-after=drive"], environment)
    found = {}
    for line, part in zip(text.splitlines(), parts, strict=False):
        name, choice, units, _ = line.split("\t")
        own = name + ".so"
        spent = sum(c.instructions for c in part.calls
                    if os.path.basename(c.callee_object) == own and os.path.basename(c.caller_object) != own)
        assert spent > 0, f"callgrind saw no call of {name}"
        found[name + (", " + choice if choice else "")] = spent / int(units)
    assert len(found) == len(parts) - 1, "a dump for each choice and one at the end"
    return found


def plugins(folder):
    return sorted(os.path.join(folder, f) for f in os.listdir(folder) if f.endswith(".so") and f not in ELSEWHERE)


def measure():
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    environment.pop("CALX_BENCH_STATES", None)
    figures, kernels = {}, set()
    with tempfile.TemporaryDirectory(prefix="calx-instructions-") as folder:
        for scene in sorted(SMALL):
            picked, found = count_scene(scene, folder, environment)
            kernels.add(picked)
            figures.update(found)
    figures.update(count_kernels(plugins(os.environ["CALX_PLUGINS"].split(":")[0]), environment))
    return {"kernels": ", ".join(sorted(kernels)), "compiler": COMPILER, "libc": " ".join(platform.libc_ver()),
            "valgrind": subprocess.run(["valgrind", "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout.strip(),
            "instructions": {name: float(f"{figure:.6g}") for name, figure in figures.items()}}


def judge(stored, found, bound):
    """Lines that say what is wrong."""
    wrong = []
    for name in sorted(stored.keys() | found.keys()):
        if name not in found or name not in stored:
            wrong.append(f"{name}: {'not stored' if name in found else 'stored, and not there any more'}")
            continue
        change = found[name] / stored[name] - 1
        if abs(change) > bound:
            what = "a regression" if change > 0 else "faster than stored: store it, so that it is kept"
            wrong.append(f"{name}: {found[name]:.6g} instructions, {100 * change:+.1f} % of {stored[name]:.6g}: {what}")
    return wrong


def compare(stored, now):
    if now["kernels"] != stored["kernels"]:
        print(f"the figures are those of the kernels {stored['kernels']}; under valgrind calx picks {now['kernels']} here")
        return SKIPPED
    bound = BOUND
    for what in ("compiler", "libc", "valgrind"):
        if now[what] != stored[what]:
            bound = OTHER_VERSION
            print(f"{what} is {now[what]}, the figures are those of {stored[what]}: compared within {100 * bound:g} %, not "
                  f"{100 * BOUND:g} %")
    wrong = judge(stored["instructions"], now["instructions"], bound)
    print("\n".join(wrong + [f"{len(now['instructions'])} figures, {len(wrong)} wrong (kernels: {now['kernels']})"]))
    if wrong:
        print("If the change is meant: meson compile -C BUILD store-instructions")
    return 1 if wrong else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--store", action="store_true", help="write " + os.path.relpath(STORED, HERE) + " anew")
    store = parser.parse_args().store
    if not shutil.which("valgrind"):
        print("valgrind is not installed: no instructions counted")
        return 1 if store else SKIPPED
    if not store:
        with open(STORED, encoding="ascii") as file:
            stored = json.load(file)
        if COMPILER.split()[0] != stored["compiler"].split()[0]:
            print(f"the figures are those of {stored['compiler']}; this build is by {COMPILER}: nothing to compare")
            return SKIPPED
        return compare(stored, measure())
    now = measure()
    with open(STORED, "w", encoding="ascii") as file:
        json.dump(now, file, indent=1)
        file.write("\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
