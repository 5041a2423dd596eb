# SPDX-License-Identifier: BSD-3-Clause
"""Checks with ParaView itself that a result opens and says what the CSV says.

    pvpython check_series.py RESULT_DIR NAME [--case CASE.xml] [--particles N] [--network] [--no-walls]
             [--cells SUFFIX NUMBER]

One line PASS or FAIL per check; exit status 1 if any failed. With --case, probes of one grain's scalars are compared too.
"""
import argparse
import csv
import math
import os
import xml.etree.ElementTree as ElementTree

from paraview import servermanager, simple

# name: components, VTK's words for the type; (units are in paraview/README.md)
REAL = ("double", "float")
GRAINS = {"id": (1, ("long", "long long")), "radius": (1, REAL), "velocity": (3, REAL), "spin": (3, REAL),
          "temperature": (1, REAL), "heat": (1, REAL), "force": (3, REAL), "mass": (1, REAL),
          "material": (1, ("int",)), "contacts": (1, ("int",)), "group": (1, ("int",))}
WALL_POINTS = {"velocity": (3, REAL)}
WALL_CELLS = {"wall": (1, ("int",)), "temperature": (1, REAL), "force": (3, REAL)}
CONTACT_CELLS = {"pair": (2, ("long", "long long")), "normal_force": (1, REAL), "tangential_force": (1, REAL),
                 "heat_flow": (1, REAL), "overlap": (1, REAL), "status": (1, ("int",))}
PROBES = {"temperature": "temperature", "radius": "radius", "mass": "mass"}  # quantity of a probe: array

DOUBLE = 0.0  # the same number is written to both files: not one bit may differ
SINGLE = 2.0**-24  # half a unit in the last place of a 32-bit float, relative
SUM = 1e-12  # a mean of up to 1e4 numbers: 1e4 * 2^-53, in whatever order they are added


def say(text):
    """To the file descriptor itself: what pvpython holds in its own streams is lost when the process leaves at once, below."""
    os.write(1, (text + "\n").encode())


class Report:
    def __init__(self):
        self.failed = 0

    def check(self, good, text, detail=""):
        self.failed += not good
        say("%s  %s%s" % ("PASS" if good else "FAIL", text, "" if good or not detail else ": " + str(detail)))
        return good


def read_csv(path):
    """Columns by name without unit, as floats."""
    with open(path, newline="") as stream:
        rows = list(csv.reader(stream))
    names = [title.split(" [")[0] for title in rows[0]]
    return {name: [float(row[k]) for row in rows[1:]] for k, name in enumerate(names)}


def listed(path):
    """Times and files of a .pvd."""
    nodes = list(ElementTree.parse(path).getroot().iter("DataSet"))
    return [float(n.get("timestep")) for n in nodes], [os.path.join(os.path.dirname(path), n.get("file")) for n in nodes]


class Series:
    """A .pvd opened by ParaView."""

    def __init__(self, path):
        self.path = path
        self.reader = simple.PVDReader(FileName=path)
        self.reader.UpdatePipeline()
        times = self.reader.TimestepValues
        self.times = list(times) if hasattr(times, "__len__") else [times]

    def at(self, time):
        """The data of that time, as VTK has them."""
        self.reader.UpdatePipeline(time)
        return servermanager.Fetch(self.reader)


def arrays(attributes):
    return {attributes.GetArrayName(k): attributes.GetAbstractArray(k) for k in range(attributes.GetNumberOfArrays())}


def values(array):
    return [array.GetComponent(i, c) for i in range(array.GetNumberOfTuples()) for c in range(array.GetNumberOfComponents())]


def rounding(array):
    return SINGLE if array.GetDataTypeAsString() == "float" else DOUBLE


def near(a, b, relative):
    return a == b or abs(a - b) <= relative * max(abs(a), abs(b)) or (math.isnan(a) and math.isnan(b))


def check_times(report, series, table):
    name = os.path.basename(series.path)
    times, files = listed(series.path)
    missing = [file for file in files if not os.path.isfile(file)]
    report.check(not missing, "%s: all files are there" % name, missing)
    report.check(series.times == times, "%s: %d times as listed" % (name, len(times)), (series.times, times))
    report.check(all(a < b for a, b in zip(times, times[1:])), "%s: times rise" % name, times)
    if table:
        known = set(table["time"])
        common = [t for t in times if t in known]
        report.check(bool(common), "%s: %d times are rows of the CSV" % (name, len(common)), times)


def check_arrays(report, name, found, expected, required, tuples):
    """Names, components, types, lengths; and that nothing but NaN of insulated walls is not finite."""
    report.check(not set(found) - set(expected), "%s: only documented arrays" % name, sorted(set(found) - set(expected)))
    report.check(required <= set(found), "%s: has %s" % (name, ", ".join(sorted(required))), sorted(found))
    for key in sorted(set(found) & set(expected)):
        components, types = expected[key]
        array = found[key]
        good = array.GetNumberOfComponents() == components and array.GetDataTypeAsString() in types
        report.check(good and array.GetNumberOfTuples() == tuples, "%s: %s is %d x %s" % (name, key, components, types[0]),
                     (array.GetNumberOfComponents(), array.GetDataTypeAsString(), array.GetNumberOfTuples(), tuples))
        if key != "temperature" or "wall" not in found:
            report.check(all(math.isfinite(v) for v in values(array)), "%s: %s is finite" % (name, key))


def check_temperatures(report, found, table, row, label):
    array = found["temperature"]
    grains = values(array)
    for column, got, relative in (("temperature_min", min(grains), 0.0), ("temperature_max", max(grains), 0.0),
                                  ("temperature_mean", math.fsum(grains) / len(grains), SUM)):
        if column in table:
            expected = table[column][row]
            report.check(near(got, expected, rounding(array) + relative), "%s: %s as in the CSV" % (label, column), (got, expected))


def check_probes(report, found, probes, table, row, label):
    places = {int(v): k for k, v in enumerate(values(found["id"]))}
    for column, quantity, particle in probes:
        if column not in table or quantity not in found:
            continue
        array, expected = found[quantity], table[column][row]
        got = array.GetComponent(places[particle], 0)
        report.check(near(got, expected, rounding(array)), "%s: %s of grain %d is probe %s" % (label, quantity, particle, column),
                     (got, expected))


def check_grains(report, series, table, probes, options):
    counts = set()
    for time in series.times:
        data = series.at(time)
        label = "grains at %.9g s" % time
        found = arrays(data.GetPointData())
        n = data.GetNumberOfPoints()
        counts.add(n)
        check_arrays(report, label, found, GRAINS, {"id", "radius"} if n else set(), n)
        if not n:
            continue
        report.check(len(set(values(found["id"]))) == n, "%s: ids differ" % label)
        report.check(min(values(found["radius"])) > 0, "%s: radii are positive" % label)
        stamp = arrays(data.GetFieldData()).get("TimeValue")
        report.check(stamp is not None and stamp.GetComponent(0, 0) == time, "%s: TimeValue" % label)
        row = table["time"].index(time) if table and time in table["time"] else None
        if row is None:
            continue
        if "particles" in table:
            report.check(table["particles"][row] == n, "%s: as many grains as in the CSV" % label, (n, table["particles"][row]))
        if "temperature" in found:
            check_temperatures(report, found, table, row, label)
        check_probes(report, found, probes, table, row, label)
    if options.particles is not None:
        report.check(counts == {options.particles}, "%d grains in every frame" % options.particles, counts)
    else:
        report.check(len(counts) == 1, "as many grains in every frame", counts)


def check_walls(report, series, grains):
    check_times(report, series, None)
    report.check(series.times == grains.times, "walls: the times of the grains", series.times)
    for time in series.times:
        data = series.at(time)
        label = "walls at %.9g s" % time
        report.check(data.GetNumberOfCells() > 0, "%s: are there" % label)
        check_arrays(report, label, arrays(data.GetPointData()), WALL_POINTS, {"velocity"}, data.GetNumberOfPoints())
        check_arrays(report, label, arrays(data.GetCellData()), WALL_CELLS, {"wall"}, data.GetNumberOfCells())


def check_contacts(report, series, grains, table):
    check_times(report, series, None)
    report.check(series.times == grains.times, "contacts: the times of the grains", series.times)
    for time in series.times:
        data, grain = series.at(time), grains.at(time)
        label, n = "contacts at %.9g s" % time, data.GetNumberOfCells()
        report.check(data.GetNumberOfPoints() == 2 * n, "%s: two ends each" % label)
        found = arrays(data.GetCellData())
        check_arrays(report, label, found, CONTACT_CELLS, set(CONTACT_CELLS) - {"heat_flow"} if n else set(), n)
        if not n:
            continue
        row = table["time"].index(time) if table and time in table["time"] else None
        if row is not None and "contacts" in table:
            touching = sum(v > 0 for v in values(found["overlap"]))
            report.check(touching == table["contacts"][row], "%s: as many as in the CSV" % label, (touching, table["contacts"][row]))
        places = {int(v): k for k, v in enumerate(values(arrays(grain.GetPointData())["id"]))}
        first = [places.get(int(found["pair"].GetComponent(c, 0))) for c in range(n)]
        first = all(i is not None and data.GetPoint(2 * c) == grain.GetPoint(i) for c, i in enumerate(first))
        report.check(first, "%s: begin at the centre of the first grain" % label)


def check_cells(report, stem, suffix, cells):
    """A series of cells; if it has a CSV of its own, with a row per time and cell, the same numbers stand in both."""
    series = Series("%s_%s.pvd" % (stem, suffix))
    check_times(report, series, None)
    table = read_csv("%s_%s.csv" % (stem, suffix)) if os.path.exists("%s_%s.csv" % (stem, suffix)) else None
    for number, time in enumerate(series.times):
        data = series.at(time)
        label, found = "%s at %.9g s" % (suffix, time), arrays(data.GetCellData())
        report.check(data.GetNumberOfCells() == cells, "%s: %d cells" % (label, cells), data.GetNumberOfCells())
        report.check(min(data.GetCell(c).GetLength2() for c in range(cells)) > 0, "%s: cells have a size" % label)
        report.check(bool(found), "%s: arrays" % label)
        for key, array in found.items() if table else []:
            n = array.GetNumberOfComponents()
            ends = [""] if n == 1 else ["_" + c for c in "xyz"] if n == 3 else ["_" + a + b for a in "xyz" for b in "xyz"]
            same = all(near(array.GetComponent(c, k), table[key + end][number * cells + c], rounding(array))
                       for c in range(cells) for k, end in enumerate(ends) if key + end in table)
            report.check(same and any(key + end in table for end in ends), "%s: %s as in the CSV" % (label, key))


def read_probes(path):
    """(name, quantity, particle) of the case's probes of one grain's scalar."""
    nodes = ElementTree.parse(path).getroot().iter("probe") if path else []
    return [(n.get("name"), PROBES[n.get("of")], int(n.get("particle"))) for n in nodes
            if n.get("particle") is not None and n.get("of") in PROBES]


def companion(report, stem, suffix, wanted, forbidden, what):
    path = "%s_%s.pvd" % (stem, suffix)
    there = os.path.exists(path)
    if wanted:
        report.check(there, "there are %s" % what, path)
    if forbidden:
        report.check(not there, "there are no %s" % what, path)
    return Series(path) if there else None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("name")
    parser.add_argument("--case", help="the case file: its probes of single grains are compared")
    parser.add_argument("--particles", type=int, help="number of grains in every frame")
    parser.add_argument("--network", action="store_true", help="the contact network must be there")
    parser.add_argument("--no-walls", action="store_true", help="there must be no walls")
    parser.add_argument("--cells", nargs=2, action="append", default=[], metavar=("SUFFIX", "NUMBER"),
                        help="there must be a series NAME_SUFFIX of so many cells")
    options = parser.parse_args()
    stem = os.path.join(options.folder, options.name)
    report = Report()
    if report.check(os.path.isfile(stem + ".pvd"), "there is %s.pvd" % options.name):
        table = read_csv(stem + ".csv") if os.path.exists(stem + ".csv") else None
        report.check(table is not None, "there is %s.csv" % options.name)
        grains = Series(stem + ".pvd")
        check_times(report, grains, table)
        check_grains(report, grains, table, read_probes(options.case), options)
        walls = companion(report, stem, "walls", False, options.no_walls, "walls")
        if walls:
            check_walls(report, walls, grains)
        contacts = companion(report, stem, "contacts", options.network, False, "contacts")
        if contacts:
            check_contacts(report, contacts, grains, table)
        for suffix, cells in options.cells:
            check_cells(report, stem, suffix, int(cells))
    say("%s: %s" % (stem, "%d checks failed" % report.failed if report.failed else "all checks passed"))
    return 1 if report.failed else 0


if __name__ == "__main__":
    status = main()
    os._exit(status)  # pvpython may crash on its way out, which would hide the status
