# SPDX-License-Identifier: BSD-3-Clause
"""Tables in tests/bench/README.md, between the marks of the script that writes them."""

import os
import re
import subprocess
import time

HERE = os.path.dirname(os.path.abspath(__file__))
README = os.path.join(HERE, "README.md")


def origin():
    """Commit, day and machine of the figures."""
    commit = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=HERE, stdout=subprocess.PIPE, text=True,
                            check=False).stdout.strip() or "unknown"
    with open("/proc/cpuinfo", encoding="ascii") as file:
        model = re.search(r"model name\s*: (.*)", file.read()).group(1)
    return f"Commit {commit}, {time.strftime('%Y-%m-%d')}; {model}, {os.cpu_count()} cores."


def write(script, text):
    start, end = f"<!-- table: written by tests/bench/{script} -->\n", "<!-- end of table -->\n"
    with open(README, encoding="utf-8") as file:
        before, rest = file.read().split(start)
    with open(README, "w", encoding="utf-8") as file:
        file.write(before + start + text + end + rest.split(end, 1)[1])
