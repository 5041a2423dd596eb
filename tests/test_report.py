#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""`calx report`: measured orders and verdicts on cases whose errors are known in closed form, a user's own integrator, kills and
resumes, budget by counted work, statistics where paths are chaotic, mistakes. No test asserts a time.

The program is $CALX_PROGRAM, its plugins are in $CALX_PLUGINS, the sources in $CALX_SOURCE_ROOT."""

import csv
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = os.path.abspath(os.environ.get("CALX_SOURCE_ROOT", "."))
PROGRAM = os.environ.get("CALX_PROGRAM", os.path.join(ROOT, "build", "io", "calx"))
ACCURACY = os.path.join(ROOT, "cases", "accuracy")
DRUM = os.path.join(ROOT, "cases", "07-drum-with-flights")
PLENTY = "1000s"  # a budget that lets every plan be the richest: no test depends on the machine
# A drum of few grains for a short while: it settles and then turns.
SHORT_DRUM = ["--set", "particles/pack/count=40", "--set", "stage[settle]/for=0.1 s", "--set", "stage[turn]/for=0.4 s",
              "--set", "particles/pack/radius=uniform 5 mm 7 mm"]
OSCILLATOR_MASS, OSCILLATOR_STIFFNESS = 7800 * 4 / 3 * math.pi * 0.002**3, 2 * 6000
OSCILLATOR = math.sqrt(OSCILLATOR_STIFFNESS / OSCILLATOR_MASS)  # rad/s


def calx(*words, **options):
    options.setdefault("env", os.environ)
    return subprocess.run([PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=900,
                          **options)


def accuracy(name):
    return os.path.join(ACCURACY, name + ".xml")


class InFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="calx-report-")
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, *parts):
        return os.path.join(self.folder, *parts)

    def report(self, case, *words, name="out", **options):
        done = calx("report", case, "--json", "--quiet", "--threads", "1", "--out", self.path(name), *words, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def rows(self, name="out"):
        with open(self.path(name, "report.csv"), encoding="ascii") as file:
            return list(csv.DictReader(file))


def order_of(report, integrator, quantity):
    return next(i["orders"][quantity] for i in report["integrators"] if i["name"] == integrator)


class Usage(InFolder):
    REFUSED = [
        ([], "missing operand"), (["nowhere.xml"], "nowhere.xml"),
        ([accuracy("linear"), "--steps", "1e-6"], "1e-6..1e-4"), ([accuracy("linear"), "--steps", "1e-4..1e-6"], "not above"),
        ([accuracy("linear"), "--steps", "0..1e-6"], "above 0"), ([accuracy("linear"), "--steps", "1 kg..2 kg"], "'kg'"),
        ([accuracy("linear"), "--steps", ""], "two steps"), ([accuracy("linear"), "--heat-steps", "1"], "--heat-steps"),
        ([accuracy("linear"), "--integrators", "velocity-verlte"], "velocity-verlet"),
        ([accuracy("linear"), "--integrators", "heat-theta"], "heat-theta"), ([accuracy("linear"), "--integrators", ""], "names"),
        ([accuracy("linear"), "--integrators", "gear:ordr=5"], "'order'"), ([accuracy("linear"), "--integrators", "nscd:solver=apg"], "nsgs|apgd"),
        ([accuracy("linear"), "--integrators", "nscd:relaxation"], "with a value"),
        ([accuracy("linear"), "--integrators", "nscd:relaxation=2"], "less than 2"),
        ([accuracy("linear"), "--integrators", "nscd:reach=1 m"], "'m'"), ([accuracy("linear"), "--integrators", "nscd:"], "no parameter ''"),
        ([accuracy("linear"), "--integrators", "nscd" + 8 * ":theta=0.5" + ":theta=1"], "up to 8"),
        ([accuracy("linear"), "--integrators", "nscd" + 20 * ":theta=0.5"], "longer than"),
        ([accuracy("linear"), "--quantity", "reboudn"], "rebound"), ([accuracy("linear"), "--quantity", "temperatures"], "none"),
        ([accuracy("conduction-pair"), "--quantity", "paths"], "nothing moves"),
        ([accuracy("conduction-pair"), "--stability"], "nothing moves"),
        ([accuracy("linear"), "--target", "0"], "above 0"), ([accuracy("linear"), "--target", "2"], "at most 1"),
        ([accuracy("linear"), "--target", "x"], "--target"), ([accuracy("linear"), "--budget", "3 m"], "--budget"),
        ([accuracy("linear"), "--budget", "-1"], "above 0"), ([accuracy("linear"), "--seeds", "1"], "from 2"),
        ([accuracy("linear"), "--again", "1"], "from 2"), ([accuracy("linear"), "--tolerances", "1e-3"], "two numbers"),
        ([accuracy("linear"), "--tolerances", "1e-3..1e-6"], "not above"), ([accuracy("linear"), "--tolerances", "1 s..2 s"], "'s'"),
        ([accuracy("linear"), "--tolerances", "1e-9..1e-6", "--integrators", "velocity-verlet"], "no integrator"),
        ([accuracy("linear"), "--soften", "0.5"], "above 1"), ([accuracy("linear"), "--soften", "10;100"], "commas"),
        ([accuracy("linear"), "--stabilty"], "--stability"),
        ([accuracy("linear"), "--set", "contact/stiffnes=3"], "stiffness"),
    ]

    def test_mistakes_are_refused(self):
        for words, says in self.REFUSED:
            with self.subTest(words=words):
                done = calx("report", *words, cwd=self.folder)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(says, done.stderr)
                self.assertEqual(done.stdout, "")

    def test_without_gnuplot_everything_but_the_pictures(self):
        done = calx("report", accuracy("linear"), "--out", self.path("out"), env={**os.environ, "PATH": self.folder})
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([line for line in done.stderr.splitlines() if "gnuplot" in line][0][:5], "calx:")
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["report.csv", "report.gp", "report.md", "report.runs"])
        with open(self.path("out", "report.md"), encoding="utf-8") as file:
            self.assertNotIn("![", file.read())

    def test_the_page_begins_with_the_verdict_and_shows_the_picture(self):
        done = calx("report", accuracy("linear"), "--out", self.path("out"), "--target", "0.01")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path("out", "report.md"), encoding="utf-8") as file:
            lines = file.read().splitlines()
        self.assertTrue(lines[2].startswith("**For 1 % in rebound use "), lines[2])
        self.assertIn(lines[2].strip("*"), done.stdout)
        self.assertIn("![error against run time](report.png)", lines)
        for name, begins in (("report.png", b"\x89PNG"), ("report.svg", b"<?xml")):
            with open(self.path("out", name), "rb") as file:
                self.assertTrue(file.read(8).startswith(begins))


class Errors(InFolder):
    # Slack of an order: points reach up to 0.3 of the limit, where the next term of the error, of relative size (w dt)^2/4 <
    # 0.1, bends the line; contacts scatter with their phase (8 replicas).
    def test_the_oscillator_has_order_two_and_the_known_error(self):
        report = self.report(accuracy("oscillator"), "--budget", PLENTY)
        self.assertEqual(report["reference"], "exact")
        self.assertAlmostEqual(order_of(report, "velocity-verlet", "height"), 2, delta=0.05)
        # The phase runs ahead by t w^3 dt^2/24: rms over [0, T] of a sin(w t) times that, over the range 2 a, is
        # T w^3 dt^2/24/sqrt(24) up to a term 1/(w T) = 1.5 %; replicas, whose steps differ by up to 6 %, add 0.3 %, and the
        # 47 samples catch the sine's square to 10 %.
        for point in report["points"]:
            if point["integrator"] == "velocity-verlet" and point["dt"] < 2e-5:
                expected = 0.01 * OSCILLATOR**3 * point["dt"] ** 2 / 24 / math.sqrt(24)
                self.assertAlmostEqual(point["errors"]["height"][0] / expected, 1, delta=0.12)

    def test_orders_of_collisions(self):
        # Table of velocity Verlet: linear elastic 2.0, Hertz elastic 2.5, damped 1; within 0.2.
        for case, quantity, order in (("linear", "rebound", 2), ("hertz", "rebound", 2.5), ("linear-damped", "height", 1),
                                      ("hertz-damped", "rebound", 1.05)):
            with self.subTest(case=case):
                report = self.report(accuracy(case), "--budget", PLENTY, "--integrators", "velocity-verlet", name=case)
                self.assertAlmostEqual(order_of(report, "velocity-verlet", quantity), order, delta=0.2)

    def test_heat(self):
        report = self.report(accuracy("conduction-pair"), "--budget", PLENTY)
        self.assertAlmostEqual(order_of(report, "heat-theta", "T0"), 2, delta=0.1)
        self.assertAlmostEqual(order_of(report, "heat-euler", "T0"), 1, delta=0.1)
        verdict = report["verdicts"][0]
        self.assertEqual(verdict["integrator"], "heat-exponential")  # without error while the contact stays as it is

    def test_a_reference_run_gives_the_errors_of_the_exact_solution(self):
        """Without the exact solution, errors are against extrapolated runs: the same, as long as they are above its uncertainty."""
        words = ["--steps", "2e-6..1.6e-5", "--integrators", "velocity-verlet", "--budget", PLENTY]
        with open(accuracy("oscillator"), encoding="utf-8") as file:
            text = file.read()
        start, end = text.index("<exact"), text.index("/>", text.index("<exact")) + 2
        with open(self.path("plain.xml"), "w", encoding="utf-8") as file:
            file.write(text[:start] + text[end:])
        exact = self.report(accuracy("oscillator"), *words, name="exact")
        plain = self.report(self.path("plain.xml"), *words, "--quantity", "height", name="plain")
        self.assertEqual((exact["reference"], plain["reference"]), ("exact", "converged"))
        self.assertLess(plain["verdicts"][0]["reference_uncertainty"], 1e-4)
        for a, b in zip(exact["points"], plain["points"]):
            self.assertAlmostEqual(a["dt"] / b["dt"], 1, delta=0.2)  # the second divide the time between samples
            scaled = b["errors"]["height"][0] * (a["dt"] / b["dt"]) ** 2
            self.assertAlmostEqual(a["errors"]["height"][0] / scaled, 1, delta=0.25)

    def test_softer_contacts_and_heat_steps_join(self):
        report = self.report(accuracy("linear"), "--soften", "4,100", "--integrators", "velocity-verlet", "--budget", "20s")
        self.assertEqual({p["stiffness_factor"] for p in report["points"]}, {1, 0.25, 0.01})
        # A hundredth of the stiffness: from 0.4 to 0.6 ms the velocity is still -0.5 cos(w' t'), w' t' from 0.328 to 0.546, where 0.5
        # is right: errors between 1.855 and 1.947. A quarter: w' t' from 1.64 to 2.73, errors from 0.93 down to 0.08.
        for factor, least, most in ((0.01, 1.855, 1.947), (0.25, 0.4, 0.7)):
            errors = [p["errors"]["rebound"][0] for p in report["points"] if p["stiffness_factor"] == factor and p["dt"] < 1e-5]
            self.assertGreater(len(errors), 2)
            self.assertGreater(min(errors), least)
            self.assertLess(max(errors), most)
        report = self.report(os.path.join(ROOT, "cases", "05-hot-heap"), "--set", "stage[1]/for=2 ms", "--set", "stage[2]/for=2 ms", "--heat-steps", "1e-4..4e-4",
                             "--integrators", "velocity-verlet", "--budget", "20s", name="heat")
        heat_steps = sorted({p["heat_dt"] for p in report["points"]} - {None})
        self.assertGreaterEqual(len(heat_steps), 3)
        self.assertAlmostEqual(heat_steps[0] / 1e-4, 1, delta=0.01)
        self.assertAlmostEqual(heat_steps[-1] / 4e-4, 1, delta=0.01)


    def test_peak_force(self):
        # Velocity Verlet's amplitude is larger by 1/sqrt(1 - (w dt/2)^2), w = sqrt(k/m); onset inside a step adds as much again, either way. The
        # parabola between steps adds (w dt)^4/100, where the largest of the steps alone would be smaller by (w dt)^2/24 on average.
        report = self.report(accuracy("linear"), "--quantity", "peak-force,peak-force-time", "--integrators", "velocity-verlet", "--budget", PLENTY)
        self.assertAlmostEqual(order_of(report, "velocity-verlet", "peak-force"), 2, delta=0.2)
        w = math.sqrt(1e4 / (2500 * 4 / 3 * math.pi * 0.002**3))
        for point in report["points"]:
            if point["status"] == "good" and point["dt"] < 2e-5:
                self.assertLess(point["errors"]["peak-force"][0], 1.2 * (w * point["dt"]) ** 2 / 4)
        verdict = report["verdicts"][0]
        self.assertAlmostEqual(verdict["scale"] / (0.5 * 1e4 / w), 1, delta=1e-12)

    def test_tolerances(self):
        report = self.report(accuracy("linear"), "--integrators", "cash-karp,velocity-verlet", "--tolerances", "1e-8..1e-3", "--budget", PLENTY)
        points = [p for p in report["points"] if p["tolerance"]]
        self.assertEqual({p["integrator"] for p in points}, {"cash-karp"})
        self.assertEqual([round(math.log10(p["tolerance"])) for p in points], [-3, -4, -5, -6, -7, -8])
        self.assertEqual({p["dt"] for p in points}, {report["own_dt"]})
        errors = {round(math.log10(p["tolerance"])): p["errors"]["rebound"][0] for p in points}
        self.assertLess(errors[-8], errors[-3] + 1e-12)
        heat = self.report(accuracy("conduction-chain"), "--integrators", "heat-exponential", "--tolerances", "1e-12..1e-3", "--budget", PLENTY,
                           name="heat")
        self.assertEqual(len([p for p in heat["points"] if p["tolerance"]]), 10)

    def test_solvers(self):
        # The forces of this packing are determined by balance alone: each solver comes to them, from nothing in each step, as its tolerance says.
        # What is left of the conditions comes back as an error of the forces, times w_n over the least eigenvalue of W: 2 (2 N + 1)^2/pi^2 for a column
        # of N, 34 for the six layers here (33 came out). It is no column: three times that. 1e-6: of the solution that the case gives.
        choices = ["nscd:solver=nsgs", "nscd:relaxation=1.5", "nscd:order=bottom-up", "nscd:solver=apgd"]
        case = os.path.join(ROOT, "cases", "21-soft-to-rigid", "case.xml")
        report = self.report(case, "--integrators", ",".join(choices), "--tolerances", "1e-6..1e-2", "--steps", "2e-4..2e-4", "--quantity", "left",
                             "--set", "integrator/warm-start=no", "--set", "integrator/accuracy=1", "--set", "integrator/tolerance=1e-4",
                             "--budget", PLENTY)
        self.assertEqual({i["name"] for i in report["integrators"]}, set(choices))
        self.assertEqual([i["name"] for i in report["integrators"] if i["own"]], choices[:1])
        for choice in choices:
            errors = {round(math.log10(p["tolerance"])): p["errors"]["left"][0] for p in report["points"]
                      if p["integrator"] == choice and p["tolerance"]}
            self.assertEqual(sorted(errors), list(range(-6, -1)))
            for exponent, error in errors.items():
                self.assertLess(error, 100 * 10**exponent + 1e-6, (choice, exponent))
            self.assertGreater(errors[-2], 100 * errors[-6])
        self.assertEqual(len({p["errors"]["left"][0] for p in report["points"] if p["tolerance"] and p["tolerance"] > 9e-5}), 12)

    def test_a_choice_changes_what_is_run(self):
        # Without damping Gear's schemes gain an order: what counts here is that these are two schemes, two orders apart. At its limit, 304 us,
        # that of third order would move the body by more than half its radius in a step: the step is what is wrong there, not the integrator.
        report = self.report(accuracy("oscillator"), "--integrators", "gear:order=3,gear:order=5", "--steps", "1e-6..2e-5", "--budget", PLENTY)
        self.assertEqual([i["refused"] for i in report["integrators"]], ["", ""])
        self.assertAlmostEqual(order_of(report, "gear:order=5", "height") - order_of(report, "gear:order=3", "height"), 2, delta=0.1)


class Verdicts(InFolder):
    def plugins_with_own(self):
        """Builds a user's integrator as plugins/README.md says, and returns the environment in which calx finds it."""
        subprocess.run(["cc", "-O3", "-fPIC", "-shared", "-fvisibility=hidden", "-ffp-contract=off", "-I", ROOT,
                        os.path.join(ROOT, "tests", "plugins", "motion-kick-drift.c"), "-o",
                        self.path("motion-kick-drift.so"), "-lm"], check=True)
        return {**os.environ, "CALX_PLUGINS": self.folder + ":" + os.environ.get("CALX_PLUGINS", "")}

    def test_a_users_integrator_joins(self):
        # Its phase lags by w dt/2 (first order) and runs ahead by t w^3 dt^2/24: at dt = 2 us a tenth of the first.
        report = self.report(accuracy("oscillator"), "--integrators", "velocity-verlet,kick-drift", "--budget", PLENTY,
                             "--steps", "2e-7..2e-6", env=self.plugins_with_own())
        self.assertAlmostEqual(order_of(report, "kick-drift", "height"), 1, delta=0.1)

    def test_the_cheapest_by_counted_work_wins(self):
        report = self.report(accuracy("oscillator"), "--integrators", "velocity-verlet,kick-drift", "--budget", PLENTY,
                             "--steps", "2e-7..1e-4", env=self.plugins_with_own())
        verdict = report["verdicts"][0]
        self.assertEqual(verdict["integrator"], "velocity-verlet")
        # The first order rule needs w dt/2/sqrt(8) < 1e-3 of the range: 0.83 us, where the other needs 6.2 us.
        good = [p for p in report["points"] if p["errors"].get("height") and p["errors"]["height"][0] <= 1e-3]
        fewest = {name: min(p["evaluations"] for p in good if p["integrator"] == name)
                  for name in ("velocity-verlet", "kick-drift")}
        self.assertGreater(fewest["kick-drift"], 4 * fewest["velocity-verlet"])
        # The largest step within the target by the closed form above is on the ladder to within its ratio, sqrt(2).
        largest = math.sqrt(verdict["target"] * 24 * math.sqrt(24) / (0.01 * OSCILLATOR**3))
        self.assertLess(verdict["dt"], 1.06 * largest)
        self.assertGreater(verdict["dt"], 0.94 * largest / math.sqrt(2))
        self.assertLessEqual(verdict["error"], verdict["target"])
        self.assertAlmostEqual(verdict["own_step_finer_than_needed"], verdict["dt"] / 5e-6, delta=1e-9)

    def test_the_same_verdict_whatever_the_clock(self):
        """Times differ between two reports, the verdict and every error do not."""
        first, second = (self.report(accuracy("linear"), "--budget", PLENTY, name=name) for name in ("a", "b"))
        self.assertEqual([p["errors"] for p in first["points"]], [p["errors"] for p in second["points"]])
        self.assertEqual([p["evaluations"] for p in first["points"]], [p["evaluations"] for p in second["points"]])
        self.assertEqual(first["verdicts"][0]["integrator"], second["verdicts"][0]["integrator"])
        self.assertEqual(first["verdicts"][0]["dt"], second["verdicts"][0]["dt"])


class Interrupted(InFolder):
    CASE = [accuracy("bounce"), "--steps", "1e-6..3.2e-5", "--integrators", "velocity-verlet", "--budget", PLENTY]
    SAME = ("integrator", "dt [s]", "status", "runs", "steps", "evaluations", "error height", "confidence height")

    def numbers(self, name):
        return [[row[key] for key in self.SAME] for row in self.rows(name)]

    def test_a_killed_report_goes_on(self):
        self.report(*self.CASE, name="straight")
        runs = self.path("killed", "report.runs")
        with subprocess.Popen([PROGRAM, "report", *self.CASE, "--threads", "1", "--out", self.path("killed")],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            while process.poll() is None and not (os.path.exists(runs) and os.path.getsize(runs) > 30000):
                time.sleep(0.001)
            process.send_signal(signal.SIGKILL)
        self.assertEqual(process.returncode, -signal.SIGKILL, "it ended before it was killed: a longer case is needed")
        with open(runs, "ab") as file:  # as if the kill had hit a write
            file.write(b"\x55" * 100)
        report = self.report(*self.CASE, name="killed")
        self.assertGreater(report["resumed_runs"], 5)
        self.assertLess(report["resumed_runs"], report["runs"])
        self.assertEqual(self.numbers("killed"), self.numbers("straight"))

    def test_a_damaged_run_is_made_again(self):
        first = self.report(*self.CASE, name="damaged")
        with open(self.path("damaged", "report.runs"), "r+b") as file:  # the lowest bits of the last number of the last run
            file.seek(-8, os.SEEK_END)
            byte = file.read(1)[0]
            file.seek(-8, os.SEEK_END)
            file.write(bytes([byte ^ 1]))
        numbers = self.numbers("damaged")
        again = self.report(*self.CASE, name="damaged")
        self.assertEqual(again["resumed_runs"], first["runs"] - 1)
        self.assertEqual(self.numbers("damaged"), numbers)

    def test_another_report_does_not_take_its_runs(self):
        words = [accuracy("linear"), "--integrators", "velocity-verlet", "--budget", PLENTY]
        self.report(*words)
        self.assertGreater(self.report(*words)["resumed_runs"], 0)
        self.assertEqual(self.report(*words, "--set", "contact/stiffness=1.1e4")["resumed_runs"], 0)
        self.assertEqual(self.report(*words, "--steps", "1e-6..1e-5")["resumed_runs"], 0)


class Budget(InFolder):
    def report(self, case, *words, **options):
        """A machine that stands still for a while uses up a budget: up to three attempts."""
        for attempt in range(3):
            try:
                return super().report(case, *words, **options)
            except AssertionError as error:
                if attempt == 2 or not ("out of time" in str(error) or "budget" in str(error)):
                    raise
        raise AssertionError("unreachable")

    def test_planned_work_is_within_the_budget_and_kept(self):
        for budget in (5, 20):
            with self.subTest(budget=budget):
                report = self.report(DRUM, "--budget", f"{budget}s", name=str(budget))
                self.assertLessEqual(report["planned_seconds"], budget)
                # Beside the plan there is the look at chaos: two runs over 1/64 and perhaps 1/16 of what 0.3 of the budget
                # allows, twice, and a run that sees what a step costs later on, over 0.05 of it. Steps of a window are rounded up: 1 % at most.
                chaos = 0.3 * budget / report["seconds_per_evaluation"] * 1.4
                self.assertLessEqual(report["evaluations"], 1.01 * report["planned_evaluations"] + chaos)
                self.assertLessEqual(report["window"], report["duration"])

    def test_more_budget_compares_more(self):
        small, large = (self.report(DRUM, "--budget", b, name=b) for b in ("4s", "20s"))
        self.assertLess(small["planned_evaluations"], large["planned_evaluations"])


class Statistics(InFolder):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.mkdtemp(prefix="calx-report-")
        cls.addClassCleanup(shutil.rmtree, cls.made)
        done = calx("report", DRUM, *SHORT_DRUM, "--seeds", "4", "--budget", PLENTY, "--json", "--quiet", "--threads", "1", "--out",
                    os.path.join(cls.made, "drum"))
        assert done.returncode == 0, done.stderr
        cls.drum = json.loads(done.stdout)

    def test_paths_are_not_compared_past_decorrelation(self):
        self.assertEqual(self.drum["reference"], "statistics")
        self.assertLess(self.drum["decorrelation"], self.drum["window"])
        self.assertNotIn("paths", [v["quantity"] for v in self.drum["verdicts"]])
        paths = self.report(DRUM, *SHORT_DRUM, "--quantity", "paths", "--integrators", "velocity-verlet", "--budget", PLENTY)
        self.assertEqual(paths["reference"], "converged")
        self.assertLessEqual(paths["window"], paths["decorrelation"] * (1 + 1e-9))

    def test_a_verdict_with_its_confidence(self):
        verdict = self.drum["verdicts"][[v["quantity"] for v in self.drum["verdicts"]].index("mean")]
        self.assertEqual(self.drum["seeds"], 4)
        self.assertIsNotNone(verdict["integrator"])
        self.assertGreater(verdict["dt"], 0)
        point = next(p for p in self.drum["points"] if p["dt"] == verdict["dt"] and p["integrator"] == verdict["integrator"])
        error, confidence = point["errors"]["mean"]
        self.assertGreater(confidence, 0)
        self.assertAlmostEqual(verdict["error"], error + confidence, delta=1e-12)
        self.assertLessEqual(verdict["error"], verdict["target"] * (1 + 1e-12))

    def test_what_was_left_out_is_said(self):
        with open(os.path.join(self.made, "drum", "report.md"), encoding="utf-8") as file:
            page = file.read()
        self.assertRegex(page, r"adaptive integrators were left out.*--integrators .*cash-karp")
        self.assertRegex(page, r"nscd does not fit this case")
        rows = [line for line in page.splitlines() if " ± " in line and "| 0 ± 0 % |" in line]
        self.assertEqual(rows, [], "an integrator that was not run has no cost")

    # Of each 95 % interval one in twenty may miss, of 24 more than four in one of 200: a pass says that intervals are not too narrow by much. Runs
    # repeat bit by bit, so this does not fail by chance. With half the width a third of them misses.
    def test_what_is_promised_holds_with_ten_other_seeds(self):
        promised = held = 0
        for seed in range(4):
            report = self.report(DRUM, *SHORT_DRUM, "--set", f"particles/seed={seed + 1}", "--seeds", "4", "--again", "10", "--integrators",
                                 "velocity-verlet", "--budget", PLENTY, name=str(seed))
            for verdict in report["verdicts"]:
                again = verdict.get("again")
                if not again:
                    continue
                self.assertEqual(again["seeds"], 10)
                self.assertEqual(again["holds"], again["error"] <= verdict["error"])
                promised += 1
                held += again["holds"]
        self.assertGreaterEqual(promised, 20)
        self.assertGreaterEqual(held, promised - 4)
        with open(self.path("0", "report.md"), encoding="utf-8") as file:
            self.assertIn("The same steps with 10 other seeds", file.read())

    def test_json_has_what_it_promises(self):
        numbers = ("target", "window", "duration", "own_dt", "planned_seconds", "planned_evaluations", "evaluations", "runs",
                   "resumed_runs", "skipped_runs", "seeds", "decorrelation")
        for key in numbers:
            self.assertIsInstance(self.drum[key], (int, float), key)
        for point in self.drum["points"]:
            self.assertIn(point["status"], ("good", "unstable", "refused", "not run"))
            self.assertEqual(set(point["errors"]), {v["quantity"] for v in self.drum["verdicts"]})
        for integrator in self.drum["integrators"]:
            self.assertEqual(set(integrator), {"name", "own", "refused", "critical", "cost", "spread",
                                               "evaluations_per_step", "orders"})
        self.assertEqual(sum(i["own"] for i in self.drum["integrators"]), 1)


class Stability(InFolder):
    def test_the_oscillator_holds_up_to_its_limit(self):
        """Two springs: w = 6776/s, so that velocity Verlet is stable up to 2/w = 295 us, whatever calx estimates. The ladder's steps
        are sqrt(2) apart, so bounds end within that factor; a run of 34 steps a little above the limit may still end."""
        words = ["--integrators", "velocity-verlet", "--stability", "--quiet", "--budget", PLENTY]
        done = calx("report", accuracy("oscillator"), *words, "--out", self.path("out"))
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path("out", "stability.csv"), encoding="ascii") as file:
            rows = [r for r in csv.DictReader(file) if r["stiffness_factor"] == "1"]
        steps = [(float(r["step_over_limit"]) * float(r["limit [s]"]) * OSCILLATOR / 2, r) for r in rows]
        self.assertTrue(all(r["bounds"] == "1" for step, r in steps if step < 0.7))
        self.assertTrue(all(r["bounds"] == "0" for step, r in steps if step > 1.5))
        self.assertTrue(any(step > 1.5 for step, _ in steps))
        # A quarter of the limit is in the second order range; at the limit nothing is.
        self.assertTrue(all(r["order_holds"] == "1" for step, r in steps if step < 0.3))
        self.assertTrue(all(abs(float(r["order"]) - 2) < 0.3 for step, r in steps if 0.15 < step < 0.3))
        self.assertTrue(any(0.15 < step < 0.3 for step, _ in steps))
        for name in ("stability.md", "stability.png", "stability.svg"):
            self.assertTrue(os.path.getsize(self.path("out", name)) > 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[1:], verbosity=1)
