# SPDX-License-Identifier: BSD-3-Clause
"""Initial states of the scenes as CSV: x, y, z, radius, vx, vy, vz in SI units; spin and history of contacts begin at zero.

From the folder in the environment variable CALX_BENCH_STATES (s1*.csv.gz or s1*.csv), else made by calx from the cases in make/."""

import csv
import glob
import gzip
import os
import random
import re
import shutil
import struct
import subprocess
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))
HEADER = ["x", "y", "z", "radius", "vx", "vy", "vz"]
GAS_SPEED = 1.0  # m/s, standard deviation of each component


def stored(scene):
    folder = os.environ.get("CALX_BENCH_STATES")
    found = sorted(glob.glob(os.path.join(folder, scene + "_*.csv*"))) if folder else []
    return found[0] if found else None


def read_array(text, data, name):
    """The doubles of one array of a .vtu with appended raw data: its size and the data; if compressed the number of blocks, two
    sizes of blocks before compression, that of each block after it; then the blocks."""
    entry = re.search(rb'<DataArray type="(\w+)" Name="%s"[^>]*offset="(\d+)"' % name.encode(), text)
    start = int(entry.group(2))
    count, = struct.unpack_from("<Q", data, start)
    if b"compressor=" not in text:
        raw = data[start + 8:start + 8 + count]
    else:
        sizes = struct.unpack_from(f"<{count}Q", data, start + 24)
        at, raw = start + 24 + 8 * count, b""
        for length in sizes:
            raw += zlib.decompress(data[at:at + length])
            at += length
    return struct.unpack("<%dd" % (len(raw) // 8), raw)


def last_frame(folder, name):
    """Rows of the CSV from the last frame of the run of that name."""
    path = sorted(glob.glob(os.path.join(folder, name + "_[0-9]*.vtu")))[-1]
    with open(path, "rb") as file:
        text, data = file.read().split(b'<AppendedData encoding="raw">', 1)
    data = data.lstrip()[1:]  # white space, an underscore, the data
    place, radius, speed = (read_array(text, data, name) for name in ("position", "radius", "velocity"))
    return [place[3 * i:3 * i + 3] + (radius[i],) + speed[3 * i:3 * i + 3] for i in range(len(radius))]


def heat_gas(rows):
    """Gaussian velocities of zero sum in place of those of the rows; all grains have the same mass."""
    random.seed(1)
    speeds = [[random.gauss(0, GAS_SPEED) for _ in rows] for _ in range(3)]
    means = [sum(s) / len(rows) for s in speeds]
    return [row[:4] + tuple(s[i] - m for s, m in zip(speeds, means)) for i, row in enumerate(rows)]


def make(scene, program, environment, folder, settings=()):
    """Rows of the CSV; settings: words of calx run that change the case."""
    out = os.path.join(folder, "make-" + scene)
    case = os.path.join(HERE, "make", scene + ".xml")
    subprocess.run([program, "run", case, "--out", out, "--quiet", *settings], check=True, env=environment)
    rows = last_frame(out, scene)
    shutil.rmtree(out)
    return heat_gas(rows) if scene == "s4" else rows


def write(rows, path):
    with open(path, "w", encoding="ascii", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(HEADER)
        writer.writerows(rows)


def fetch(scene, program, environment, folder):
    """The path of the scene's CSV in `folder`, written if it is not there, and whether it is the stored state."""
    scene = scene.removesuffix("h")
    source = stored(scene)
    path = os.path.join(folder, f"{scene}-{'stored' if source else 'made'}.csv")
    if not os.path.exists(path):
        if source:
            opened = gzip.open if source.endswith(".gz") else open
            with opened(source, "rb") as file, open(path + ".part", "wb") as out:
                shutil.copyfileobj(file, out)
        else:
            print(f"making the state of {scene}", flush=True)
            write(make(scene, program, environment, folder), path + ".part")
        os.rename(path + ".part", path)
    return path, source is not None
