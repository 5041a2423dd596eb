#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The program as a user meets it: exit status, help, mistakes, --set, progress, signals, kills and resumes.

The program is $CALX_PROGRAM, its plugins are in $CALX_PLUGINS, the sources in $CALX_SOURCE_ROOT."""

import fcntl
import os
import pty
import random
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time
import unittest
import xml.etree.ElementTree as ElementTree

ROOT = os.path.abspath(os.environ.get("CALX_SOURCE_ROOT", "."))
PROGRAM = os.environ.get("CALX_PROGRAM", os.path.join(ROOT, "build", "io", "calx"))
DATA = os.path.join(ROOT, "tests", "data", "cli")
CASE = os.path.join(DATA, "drum.xml")
KILLS = 50
SIGTERM_EXIT, SIGINT_EXIT = 128 + signal.SIGTERM, 128 + signal.SIGINT


def calx(*words, **options):
    return subprocess.run([PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300,
                          **options)


def state_hash(done):
    return re.search(r"state hash: ([0-9a-f]{16})", done.stdout).group(1)


def read(path):
    with open(path, "rb") as file:
        return file.read()


def is_whole(path):
    """Whether a .vtu is complete: its header parses, and nothing is missing at its end. The data between are not XML."""
    data = read(path)
    start, end = data.find(b"<AppendedData"), data.rfind(b"</AppendedData>")
    if start < 0 or end < 0:
        return False
    ElementTree.fromstring(data[:start] + data[end + len(b"</AppendedData>"):])
    return data.rstrip().endswith(b"</VTKFile>")


def frames_of(pvd):
    """Times and files of a series, all of which must be there and whole."""
    frames = []
    for entry in ElementTree.parse(pvd).getroot().iter("DataSet"):
        file = os.path.join(os.path.dirname(pvd), entry.get("file"))
        assert is_whole(file), file
        frames.append((float(entry.get("timestep")), file))
    assert frames == sorted(frames), pvd
    return frames


class InFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="calx-cli-")

    def tearDown(self):
        shutil.rmtree(self.folder)

    def path(self, *parts):
        return os.path.join(self.folder, *parts)


class Usage(InFolder):
    # words, exit status, what stderr (failures) or stdout says
    TABLE = [
        ([], 2, "usage"),
        (["rnu"], 2, "did you mean 'run'?"),
        (["frobnicate"], 2, "no command 'frobnicate'"),
        (["run"], 2, "missing operand"),
        (["run", CASE, CASE], 2, "one operand too many"),
        (["run", CASE, "--ot", "x"], 2, "did you mean --out?"),
        (["run", CASE, "--out"], 2, "--out needs a value"),
        (["run", CASE, "--quiet=yes"], 2, "--quiet takes no value"),
        (["run", CASE, "--threads", "0"], 2, "whole number"),
        (["run", CASE, "--threads", "2x"], 2, "whole number"),
        (["run", CASE, "--set", "dt"], 2, "path=value"),
        (["run", "nowhere.xml"], 2, "nowhere.xml"),
        (["run", "."], 2, "case.xml"),
        (["verify"], 2, "missing operand"),
        (["check", "nowhere"], 2, "nowhere"),
        (["check", CASE, "--resume"], 2, "no option '--resume'"),
        (["plugins", "linaer"], 2, "linear"),
        (["plugins", "linear", "--check", "x.so"], 2, "not both"),
        (["plugins", "--check", "nowhere.so"], 2, "nowhere.so"),
        (["schema", "x"], 2, "one operand too many"),
        (["--version"], 0, "calx "),
        (["--help"], 0, "exit status"),
        (["plugins"], 0, "velocity-verlet"),
        (["plugins", "coulomb"], 0, "friction"),
    ]

    def test_exit_status_and_message(self):
        for words, status, says in self.TABLE:
            with self.subTest(words=words):
                done = calx(*words, cwd=self.folder)
                self.assertEqual(done.returncode, status, done.stderr)
                self.assertIn(says, done.stderr if status else done.stdout)

    def test_every_command_explains_itself_with_examples(self):
        for command in ("run", "check", "verify", "plugins", "schema"):
            with self.subTest(command=command):
                done = calx(command, "--help")
                self.assertEqual(done.returncode, 0)
                self.assertIn(f"examples:\n  calx {command}", done.stdout)
                self.assertIn(command, calx("--help").stdout)

    def test_all_mistakes_of_a_case_come_in_one_go(self):
        mistakes = os.path.join(DATA, "mistakes.xml")
        for command in ("run", "check", "verify"):
            done = calx(command, mistakes, cwd=self.folder)
            self.assertEqual(done.returncode, 2)
            for line, word in ((2, "density"), (3, "linear"), (6, "radius")):
                found = [text for text in done.stderr.splitlines() if f"mistakes.xml:{line}:" in text]
                self.assertTrue(any(word in text for text in found), done.stderr)
        self.assertEqual(os.listdir(self.folder), [])

    # What each line alone does not show: contact and integrator, line and text of the refusal.
    TOGETHER = [
        ('plugin="coulomb" stiffness="1 N/m" friction="0.5"', 'plugin="velocity-verlet" dt="1 us"', 3, "needs a law that provides a normal force"),
        ('plugin="signorini-coulomb"', 'plugin="velocity-verlet" dt="1 us"', 3, "needs an integrator that solves for impulses (nscd)"),
        ('plugin="linear" stiffness="1 N/m"', 'plugin="nscd" dt="1 ms"', 3, "takes non-smooth laws only"),
        ('plugin="signorini-coulomb"', 'plugin="nscd"', 4, "no time step"),
        ('plugin="linear" stiffness="1e9 N/m"', 'plugin="velocity-verlet" dt="1 s"', 4, "is above the stability limit"),
    ]

    def test_what_does_not_go_together_names_the_line(self):
        for contact, integrator, line, says in self.TOGETHER:
            with self.subTest(contact=contact, integrator=integrator):
                with open(self.path("case.xml"), "w", encoding="ascii") as file:
                    file.write('<case title="x" dimension="3">\n<material name="m" density="2500 kg/m3"/>\n'
                               f'<contact {contact}/>\n<integrator {integrator}/>\n'
                               '<particles material="m" radius="1 mm"><particle at="0 0 0"/><particle at="0 0 2 mm"/></particles>\n'
                               '<stage for="1 s"/>\n</case>\n')
                done = calx("check", self.path("case.xml"))
                self.assertEqual(done.returncode, 2)
                self.assertIn(f"case.xml:{line}: ", done.stderr)
                self.assertIn(says, done.stderr)

    def test_the_schema_is_a_grammar(self):
        done = calx("schema")
        self.assertEqual(done.returncode, 0)
        self.assertEqual(ElementTree.fromstring(done.stdout).tag, "{http://relaxng.org/ns/structure/1.0}grammar")

    def test_an_output_folder_that_cannot_be_is_an_error(self):
        with open(self.path("file"), "w", encoding="ascii"):
            pass
        done = calx("run", CASE, "--out", self.path("file", "below"))
        self.assertEqual(done.returncode, 1)
        self.assertIn("file", done.stderr)


class Cases(InFolder):
    def test_check_says_what_comes_and_runs_nothing(self):
        done = calx("check", CASE, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        for word in ("steps/s", "run time", "memory", "drum.pvd", "drum_contacts.pvd", "drum.csv"):
            self.assertIn(word, done.stdout)
        self.assertEqual(os.listdir(self.folder), [])

    def test_verify_takes_folders_without_case_xml(self):
        extreme = os.path.join(ROOT, "cases", "extreme")
        names = ["16-one-particle", "17-no-particle"]
        os.mkdir(os.path.join(self.folder, "some"))
        for name in names:
            shutil.copy(os.path.join(extreme, name + ".xml"), os.path.join(self.folder, "some"))
        os.mkdir(os.path.join(self.folder, "empty"))
        with open(os.path.join(self.folder, "README.md"), "w", encoding="ascii"):
            pass
        done = calx("verify", "some", "README.md", cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("README.md: skipped", done.stderr)
        self.assertIn("2 cases:", done.stdout)
        for name in names:
            self.assertIn(name, done.stdout)
        for words, says in ((["empty"], "empty holds no case"), (["empty", "some"], "empty holds no case"), (["README.md"], "skipped")):
            done = calx("verify", *words, cwd=self.folder)
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertIn(says, done.stderr)

    def test_verify_judges_and_writes_nothing(self):
        short = ["--set", "stage[turn]/for=1 ms", "--set", "stage[settle]/for=1 ms"]
        done = calx("verify", CASE, *short, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("2 expectations passed, 0 failed", done.stdout)
        done = calx("verify", CASE, *short, "--set", "expect[1]/always=61", cwd=self.folder)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"count always +61 +60 .*FAILED +no grain gets lost")
        done = calx("verify", CASE, "nowhere", *short, cwd=self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertEqual(os.listdir(self.folder), [])

    def test_a_case_may_expect_to_be_refused(self):
        """By the reader, by the engine before the first step, or by a guard during the run; not by anything else."""
        inside = ('<material name="m" density="1000"/><contact plugin="linear" stiffness="{k}"/><integrator plugin="velocity-verlet"/>'
                  '<particles material="m" radius="0.01"><particle at="0 0 0"/><particle at="{x} 0 0" velocity="-5 0 0"/></particles>'
                  '<stage for="20 ms"/>')
        deep, fine = "overlaps particle 1", 'refusal="overlaps particle"'
        for k, x, expects, passed, failed in (
                ("1e5", "0.01", f'<expect refusal="{deep}"/><expect refusal="start without overlap"/>', 2, 0),
                ("1e2", "0.03", f'<expect refusal="{deep}"/><expect refusal="at t = 0 s"/>', 1, 1),
                ("-1", "0.03", '<expect refusal="stiffness"/>', 1, 0),
                ("1e5", "0.03", f"<expect {fine}/>", 0, 1)):
            with self.subTest(k=k, x=x):
                with open(self.path("c.xml"), "w", encoding="ascii") as file:
                    file.write(f"<case>{inside.format(k=k, x=x)}{expects}</case>")
                done = calx("verify", "c.xml", cwd=self.folder)
                self.assertEqual(done.returncode, 1 if failed else 0, done.stdout + done.stderr)
                self.assertIn(f"{passed} expectations passed, {failed} failed", done.stdout)
                self.assertEqual("was not refused" in done.stdout, (k, x) == ("1e5", "0.03"))
                self.assertNotEqual(calx("run", "c.xml", "--quiet", cwd=self.folder).returncode == 0, (k, x) != ("1e5", "0.03"))

    def test_force(self):
        words = [os.path.join(ROOT, "cases", "extreme", "06-step-1.01.xml"), "--set", "stage[1]/for=0.1 s", "--out", self.path("o")]
        done = calx("run", *words)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("above the stability limit", done.stderr)
        done = calx("run", *words, "--force", "--set", "particles/particle/velocity=0 0 0")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_set_changes_the_case(self):
        done = calx("run", CASE, "--set", "stage[turn]/for=5 ms", "--set", "stage[settle]/for=10 ms", "--out", self.path("o"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("t = 0.015", done.stdout)
        self.assertAlmostEqual(frames_of(self.path("o", "drum.pvd"))[-1][0], 0.015, places=9)
        done = calx("run", CASE, "--set", "stage[trun]/for=5 ms", "--out", self.path("p"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("turn", done.stderr)

    def test_quiet_says_nothing(self):
        done = calx("run", CASE, "--quiet", "--set", "stage[settle]/for=1 ms", "--set", "stage[turn]/for=1 ms", cwd=self.folder)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        self.assertTrue(os.path.exists(self.path("results", "drum", "drum.pvd")))

    def test_a_lost_grain_stops_the_run_and_keeps_what_was_before(self):
        done = calx("run", os.path.join(DATA, "escape"), "--out", self.path("o"))
        self.assertEqual(done.returncode, 1, done.stdout)
        lost = re.search(r"t = ([0-9.]+) s particle 1 left", done.stderr)
        self.assertIsNotNone(lost, done.stderr)
        self.assertAlmostEqual(float(lost.group(1)), 0.045, delta=2e-5)  # two steps
        self.assertIn("escape_failed.vtu", done.stderr)
        self.assertTrue(is_whole(self.path("o", "escape_failed.vtu")))
        times = [frame[0] for frame in frames_of(self.path("o", "escape.pvd"))]
        self.assertEqual(len(times), 5)  # 0, 10, 20, 30, 40 ms
        done = calx("run", os.path.join(DATA, "escape"), "--out", self.path("o"), "--resume")
        self.assertEqual(done.returncode, 1)
        self.assertIn("resumed at t = 0.04", done.stderr)

    def test_the_bar_fits_the_terminal(self):
        columns = 50
        master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        with subprocess.Popen([PROGRAM, "run", CASE, "--out", self.path("o")], stdout=subprocess.DEVNULL, stderr=slave) as run:
            os.close(slave)
            text = b""
            try:
                while chunk := os.read(master, 4096):
                    text += chunk
            except OSError:  # the other end is closed
                pass
        os.close(master)
        self.assertEqual(run.returncode, 0)
        lines = [line for line in re.split(r"[\r\n]+", text.decode().replace("\033[K", "")) if line]
        bars = [line for line in lines if line.startswith("[")]
        self.assertGreater(len(bars), 0)
        self.assertTrue(all(len(line) < columns for line in bars), bars)
        self.assertIn("100%", bars[-1])


class StopAndResume(InFolder):
    """A straight run is the reference; whatever stops a run in between, what is resumed must end the same."""

    @classmethod
    def setUpClass(cls):
        cls.reference = tempfile.mkdtemp(prefix="calx-cli-")
        start = time.monotonic()
        done = calx("run", CASE, "--threads", "1", "--out", cls.reference)
        assert done.returncode == 0, done.stderr
        cls.duration = time.monotonic() - start
        cls.hash = state_hash(done)
        cls.series = sorted(name for name in os.listdir(cls.reference) if name.endswith(".pvd"))
        cls.csv = read(os.path.join(cls.reference, "drum.csv"))
        cls.profile = read(os.path.join(cls.reference, "drum_profile_height.csv"))

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.reference)

    def start(self, *words):
        return subprocess.Popen([PROGRAM, "run", CASE, "--threads", "1", "--out", self.folder, *words], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True)

    def check_same_end(self, done):
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(state_hash(done), self.hash)
        self.assertEqual(read(self.path("drum.csv")), self.csv)
        self.assertEqual(read(self.path("drum_profile_height.csv")), self.profile)
        for name in self.series:
            mine, theirs = frames_of(self.path(name)), frames_of(os.path.join(self.reference, name))
            self.assertEqual([frame[0] for frame in mine], [frame[0] for frame in theirs])
            if name == "drum_walls.pvd":
                continue  # a resumed run writes its walls once more, changed or not
            for one, other in zip(mine, theirs):
                self.assertEqual(read(one[1]), read(other[1]), one[1])

    def test_the_reference_has_its_frames_and_rows(self):
        self.assertEqual(self.series, ["drum.pvd", "drum_contacts.pvd", "drum_profile_height.pvd", "drum_walls.pvd"])
        times = [frame[0] for frame in frames_of(os.path.join(self.reference, "drum.pvd"))]
        self.assertEqual(len(times), 101)
        for number, instant in enumerate(times):
            self.assertAlmostEqual(instant, 0.002 * number, places=9)
        rows = self.csv.decode().splitlines()
        self.assertEqual(len(rows), 1 + 201)
        self.assertTrue(rows[0].startswith("time [s],step,kinetic [J]"))
        self.assertEqual(rows[0].split(",")[-2:], ["first [K]", "mixing"])

    def test_the_reference_has_its_profiles(self):
        rows = [line.split(",") for line in self.profile.decode().splitlines()]
        self.assertEqual(rows[0][:6], ["time [s]", "y [m]", "solid_fraction", "velocity_x [m/s]", "velocity_y [m/s]",
                                       "fluctuation_x [m/s]"])
        self.assertEqual(rows[0][-4:], ["kinetic_stress_xx [Pa]", "kinetic_stress_xy [Pa]", "kinetic_stress_yx [Pa]",
                                        "kinetic_stress_yy [Pa]"])
        self.assertEqual(len(rows), 1 + 20 * 6)
        for number, row in enumerate(rows[1:]):
            self.assertAlmostEqual(float(row[0]), 0.01 * (number // 6 + 1), places=9)
            self.assertAlmostEqual(float(row[1]), -0.025 + 0.01 * (number % 6), places=9)

    def test_threads_do_not_change_the_bits(self):
        self.check_same_end(calx("run", CASE, "--threads", "3", "--out", self.folder))

    def test_a_finished_run_resumes_to_itself(self):
        self.check_same_end(calx("run", CASE, "--out", self.folder))
        self.check_same_end(calx("run", CASE, "--out", self.folder, "--resume"))

    def test_signals_stop_the_run_and_say_how_to_go_on(self):
        for number, status in ((signal.SIGTERM, SIGTERM_EXIT), (signal.SIGINT, SIGINT_EXIT)):
            with self.subTest(signal=number):
                shutil.rmtree(self.folder)
                run = self.start()
                while not os.path.exists(self.path("drum_000003.vtu")):
                    time.sleep(0.002)
                run.send_signal(number)
                _, messages = run.communicate(timeout=60)
                self.assertEqual(run.returncode, status, messages)
                command = re.search(r"calx (run .* --resume)", messages).group(1)
                self.assertLess(len(frames_of(self.path("drum.pvd"))), 101)
                self.check_same_end(calx(*command.split()))

    def test_another_case_is_not_resumed(self):
        self.assertEqual(calx("run", CASE, "--out", self.folder, "--set", "stage[turn]/for=1 ms").returncode, 0)
        done = calx("run", CASE, "--out", self.folder, "--resume", "--set", "contact[1]/stiffness=5000 N/m")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("another case", done.stderr)

    def test_a_killed_run_opens_and_resumes(self):
        """Kills at random instants, also during the resumes; whoever gets through must end like the reference."""
        seed = int(os.environ.get("CALX_SEED", "1"))
        chance = random.Random(seed)
        resume = []
        finished = 0
        for kill in range(KILLS):
            run = self.start(*resume)
            delay = chance.uniform(0, 0.4 * self.duration)
            try:
                out, messages = run.communicate(timeout=delay)
                self.check_same_end(subprocess.CompletedProcess([], run.returncode, out, messages))
                finished += 1
                resume = []
                continue
            except subprocess.TimeoutExpired:
                run.kill()
                run.communicate()
            resume = ["--resume"]
            for name in self.series:
                if os.path.exists(self.path(name)):
                    frames_of(self.path(name))
        self.check_same_end(calx("run", CASE, "--out", self.folder, *resume))
        self.assertLess(finished, KILLS / 2, "too few runs were killed")


if __name__ == "__main__":
    unittest.main(argv=sys.argv, verbosity=2)
