# SPDX-License-Identifier: BSD-3-Clause
"""Input of LAMMPS (20220106) and LIGGGHTS (3.8) for the scenes, made from one table.

What the two need to compute the same physics as each other and as calx:
- LAMMPS caps spring and damper together at mu |fn|, LIGGGHTS the spring alone; both act at the arm R.
- `wall/gran ... zcylinder ... shear` of this LAMMPS lets the wall's speed grow with each step: the drum is a region that rotates.
- The `shear` of LIGGGHTS' cylinder is a rate of rotation taken at the centre of the grain: it is scaled by R/(R - r).
- `dimension 2` of LIGGGHTS makes discs: the small drum stays in 3D, where nothing pushes out of the plane z = 0."""

import math

# stiffness and damping rates: of pairs, of walls; a tangential spring of 2/7 and a damper of 1/2 of the normal ones
LINEAR = "linear"
HERTZ = "hertz"
SCENES = {
    "s1": dict(law=LINEAR, k=6000.0, rate=(898.8, 635.5), drum=(0.0762, -20.0, 2e-3), gravity="0 -1 0", dt=1e-5,
               density=8900.0, periodic="ffp", box=((-0.08, 0.08), (-0.08, 0.08), (0, 0.05)), skin=8e-4),
    "s2": dict(law=LINEAR, k=1000.0, rate=(1958.0, 1384.6), floor=True, gravity="0 0 -1", dt=5e-6, density=2500.0,
               periodic="ppf", box=((0, 0.1), (0, 0.1), (-0.002, 0.08)), skin=1e-4),
    "s3": dict(law=HERTZ, young=5e7, poisson=0.3, restitution=0.7, floor=True, gravity="0 0 -1", dt=5e-6, density=2500.0,
               periodic="ppf", box=((0, 0.1), (0, 0.1), (-0.002, 0.08)), skin=1e-4),
    "s4": dict(law=LINEAR, k=1000.0, rate=(1958.0, 1384.6), dt=5e-6, density=2500.0, periodic="ppp",
               box=((0, 0.203098),) * 3, skin=2e-3),
    "s5": dict(law=LINEAR, k=2000.0, rate=(1265.0, 894.5), drum=(0.05, -20.0, 2e-3), gravity="0 -1 0", dt=1e-5,
               density=2500.0, periodic="ffp", box=((-0.055, 0.055), (-0.055, 0.055), (-0.003, 0.003)), skin=1e-3,
               planar=True),
}
SCENES["s1h"] = dict(SCENES["s1"], conductivity=385.0, specific_heat=172.0, start=293.0, wall=373.0)
FRICTION = 0.5


def write_data(rows, scene, path):
    """The grains as a data file of both codes: type 1; type 2 is the walls' material."""
    s = SCENES[scene]
    with open(path, "w", encoding="ascii") as out:
        print(f"{scene}\n\n{len(rows)} atoms\n2 atom types", file=out)
        for axis, (low, high) in zip("xyz", s["box"]):
            print(f"{low} {high} {axis}lo {axis}hi", file=out)
        print("\nAtoms\n", file=out)
        for number, (x, y, z, radius, *_) in enumerate(rows, 1):
            print(f"{number} 1 {2 * float(radius):.17g} {s['density']} {x} {y} {z}", file=out)
        print("\nVelocities\n", file=out)
        for number, row in enumerate(rows, 1):
            print(number, *row[4:7], "0 0 0", file=out)


def begin(s, style, periodic):
    return ["units si", f"atom_style {style}", "boundary " + " ".join(periodic), "newton off"]


def middle(s, data, skin):
    return [f"read_data {data}", f"neighbor {skin or s['skin']} bin", "neigh_modify delay 0 every 1 check yes"]


def motion(s):
    lines = [f"timestep {s['dt']}", "fix move all nve/sphere"]
    if "gravity" in s:
        lines.append(f"fix weight all gravity 9.81 vector {s['gravity']}")
    return lines


def runs(warm, steps):
    """Two runs, the second of which is timed, then the state."""
    return ["thermo 1000000", "thermo_style custom step atoms ke", f"run {warm}", f"run {steps}",
            "compute touching all contact/atom", "compute sum all reduce sum c_touching",
            "compute spin all erotate/sphere", "variable pairs equal c_sum/2",
            "thermo_style custom step atoms ke c_spin v_pairs", "run 0"]


def hooke(s, which):
    rate = s["rate"][which]
    return f"hooke/history {s['k']} {s['k'] * 2 / 7:.12g} {rate} {rate / 2} {FRICTION} 1"


def lammps(scene, data, warm, steps, skin=None):
    s = SCENES[scene]
    planar = s.get("planar")
    if s["law"] == HERTZ:
        law = (f"hertz/material {s['young']} {s['restitution']} {s['poisson']} "
               f"tangential mindlin NULL 1.0 {FRICTION} damping tsuji")
        pair, wall = ["pair_style granular", f"pair_coeff * * {law}"], f"granular {law}"
    else:
        pair, wall = [f"pair_style gran/{hooke(s, 0)}", "pair_coeff * *"], hooke(s, 1)
    lines = begin(s, "sphere", s["periodic"]) + (["dimension 2"] if planar else []) + ["comm_modify vel yes"]
    lines += middle(s, data, skin) + pair + motion(s) + (["fix plane all enforce2d"] if planar else [])
    if "drum" in s:
        radius, rpm, _ = s["drum"]
        lines += [f"variable angle equal {rpm * math.pi / 30:.13g}*step*dt",
                  f"region drum cylinder z 0 0 {radius} -1 1 side in open 1 open 2 rotate v_angle 0 0 0 0 0 1",
                  f"fix wall all wall/gran/region {wall} region drum"]
    elif "floor" in s:
        lines.append(f"fix wall all wall/gran {wall} zplane 0 NULL")
    return "\n".join(lines + runs(warm, steps)) + "\n"


def table(name, of_pairs, of_walls=None):
    """A property of pairs of the two types; walls differ from pairs where of_walls says so."""
    other = of_pairs if of_walls is None else of_walls
    return f"fix {name} all property/global {name} peratomtypepair 2 {of_pairs} {other} {other} {of_pairs}"


def liggghts(scene, data, warm, steps, skin=None):
    s = SCENES[scene]
    periodic = "fff" if s.get("planar") else s["periodic"]
    lines = begin(s, "granular", periodic) + ["atom_modify map array", "communicate single vel yes"]
    lines += middle(s, data, skin) + [table("coefficientFriction", FRICTION)]
    if s["law"] == HERTZ:
        lines += [f"fix {name} all property/global {name} peratomtype {value} {value}"
                  for name, value in (("youngsModulus", s["young"]), ("poissonsRatio", s["poisson"]))]
        lines.append(table("coefficientRestitution", s["restitution"]))
        model = "hertz tangential history"
    else:
        rates = s["rate"]
        lines += [table("kn", s["k"]), table("kt", s["k"] * 2 / 7), table("gamman", *rates),
                  table("gammat", rates[0] / 2, rates[1] / 2)]
        model = "hooke/stiffness tangential history"
    lines += [f"pair_style gran model {model}", "pair_coeff * *"] + motion(s)
    heat = ""
    if "wall" in s:
        lines += [f"fix {name} all property/global {name} peratomtype {s[key]} {s[key]}"
                  for name, key in (("thermalConductivity", "conductivity"), ("thermalCapacity", "specific_heat"))]
        lines.append(f"fix heat all heat/gran/conduction initial_temperature {s['start']}")
        heat = f" temperature {s['wall']}"
    if "drum" in s:
        radius, rpm, grain = s["drum"]
        rate = rpm * math.pi / 30 * radius / (radius - grain)
        lines.append(f"fix wall all wall/gran model {model} primitive type 2 zcylinder {radius} 0. 0. shear x {rate:.9g}{heat}")
    elif "floor" in s:
        lines.append(f"fix wall all wall/gran model {model} primitive type 2 zplane 0.0")
    return "\n".join(lines + runs(warm, steps)) + "\n"
