# SPDX-License-Identifier: BSD-3-Clause
"""Pictures and films of a result of calx without a screen: the script behind paraview/render, run by pvbatch."""
import argparse
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from paraview import simple

import calx_view

FILMS = (".ogv", ".avi")


def parse_size(text):
    try:
        width, height = (int(part) for part in text.lower().split("x"))
    except ValueError:
        raise argparse.ArgumentTypeError("'%s' is not WIDTHxHEIGHT, for example 1280x960" % text)
    if not (16 <= width <= 16384 and 16 <= height <= 16384):
        raise argparse.ArgumentTypeError("'%s' is out of range: 16 to 16384 pixels each way" % text)
    return width, height


def arguments(argv):
    parser = argparse.ArgumentParser(
        prog="paraview/render",
        description="Draws a result of calx without a screen: a picture of one frame, or a film of all.",
        epilog="examples: paraview/render results/drum/drum.pvd -o drum.png --time 2.5\n"
        "          paraview/render results/drum/drum.pvd --film drum.ogv --size 800x600",
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pvd", metavar="RESULT.pvd")
    when = parser.add_mutually_exclusive_group()
    when.add_argument("--time", type=float, metavar="T", help="the frame nearest to this time, s (default: the last)")
    when.add_argument("--frame", type=int, metavar="N", help="frame number from 0; negative: from the end")
    when.add_argument("--film", metavar="OUT", help="all frames: OUT.ogv or OUT.avi, or pictures with OUT.png")
    parser.add_argument("-o", "--output", metavar="PICTURE.png", help="default: the name of the result, .png")
    parser.add_argument("--size", type=parse_size, default=(1280, 960), metavar="WxH", help="pixels (1280x960)")
    parser.add_argument("--color", metavar="FIELD", help="temperature, velocity, force, radius, ... (see paraview/README.md)")
    parser.add_argument("--range", type=float, nargs=2, metavar=("LOW", "HIGH"), help="of the colours")
    parser.add_argument("--up", choices="xyz", help="the axis that points up in 3D (default: against gravity)")
    parser.add_argument("--contacts", action="store_true", help="draw the contact network through translucent grains")
    parser.add_argument("--fps", type=float, default=25, help="frames per second of a film (25)")
    return parser.parse_args(argv)


def choose_time(times, options):
    if options.time is not None:
        return min(times, key=lambda t: abs(t - options.time))
    number = -1 if options.frame is None else options.frame
    if not -len(times) <= number < len(times):
        raise ValueError("no frame %d: there are %d" % (number, len(times)))
    return times[number]


def check_folder(path):
    folder = os.path.dirname(os.path.abspath(path))
    if not os.access(folder, os.W_OK):
        raise ValueError("cannot write '%s': no writable folder %s" % (path, folder))


def write_picture(scene, path, options):
    time = choose_time(scene.times, options)
    calx_view.set_time(scene, time)
    simple.SaveScreenshot(path, scene.view, ImageResolution=list(options.size))
    print("%s: t = %g s" % (path, time))


def write_film(scene, path, options):
    kind = os.path.splitext(path)[1].lower()
    if kind not in FILMS + (".png",):
        raise ValueError("cannot write a film '%s': use .ogv or .avi, or .png for numbered pictures" % path)
    extra = {"FrameRate": int(round(options.fps))} if kind in FILMS else {"SuffixFormat": "_%05d"}
    simple.SaveAnimation(path, scene.view, ImageResolution=list(options.size),
                         FrameWindow=[0, len(scene.times) - 1], **extra)
    print("%s: %d frames" % (path, len(scene.times)))


def main():
    options = arguments(sys.argv[1:])
    if not os.path.isfile(options.pvd):
        raise ValueError("no file '%s'" % options.pvd)
    if not options.pvd.endswith(".pvd"):
        raise ValueError("'%s' is not a .pvd file" % options.pvd)
    name = os.path.splitext(os.path.basename(options.pvd))[0]
    target = options.film or options.output or name + ".png"
    check_folder(target)
    scene = calx_view.build(options.pvd, color=options.color, span=options.range, contacts=options.contacts,
                            up=options.up, size=options.size)
    write = write_film if options.film else write_picture
    write(scene, target, options)


def finish(status):
    """Ends at once: pvbatch 5.11 crashes when a script ends it with sys.exit()."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


if __name__ == "__main__":
    try:
        main()
    except ValueError as problem:
        print("paraview/render: %s" % problem, file=sys.stderr)
        finish(2)
    except SystemExit as end:
        finish(end.code or 0)
    finish(0)
