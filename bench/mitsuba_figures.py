#!/usr/bin/env python3
"""The Cornell box of Mitsuba 3 by Mitsuba and by `holotrace render`: processor time, squared error, and their product.

Usage: mitsuba_figures.py [ROUNDS]     in a Python with Mitsuba (pip install mitsuba; its variant llvm_ad_rgb needs LLVM, such as
                                       libllvm15 of Debian: DRJIT_LIBLLVM_PATH names its libLLVM*.so)

Both take 64 paths for each of 256 x 256 pixels, box-filtered, of at most 8 surfaces, on one thread, in alternating runs with
other seeds. Mitsuba's sampler is multijitter. Its time is that of mi.render, after its code was compiled by a first run; that of
holotrace is of the whole program. The squared error of a picture is half the mean squared difference of two, so no reference
is needed. The mean of all pictures must agree within their noise: the line "means" gives the difference in standard errors.
"""

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

PROGRAM = Path(os.environ.get("HOLOTRACE", Path(__file__).resolve().parents[1] / "build" / "release" / "holotrace"))
SIDE, PATHS, SURFACES = 256, 64, 8
DISTANCE = 3.9  # of Mitsuba's camera from the origin; ours is at the origin [m]
COLOURS = ("white", "green", "red")


def reference_scene():
    """mi.cornell_box() with a box filter, as the pixels of holotrace are, and Mitsuba's best sampler."""
    scene = mi.cornell_box()
    scene["sensor"]["film"]["rfilter"] = {"type": "box"}
    scene["sensor"]["sampler"] = {"type": "multijitter", "sample_count": PATHS}
    return scene


def faces_of(kind):
    """Corners of each face of Mitsuba's rectangle or cube, counter-clockwise as seen from outside."""
    front = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
    if kind == "rectangle":
        return [front]
    front = front + [0, 0, 1]
    turn_y = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], float)
    turn_x = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)
    turns = [np.linalg.matrix_power(turn_y, n) for n in range(4)] + [turn_x, turn_x.T]
    return [front @ turn.T for turn in turns]


def write_obj(shape, file):
    """The shape in the frame of holotrace, whose camera is at the origin and looks along -z, as Mitsuba's does."""
    matrix = np.array(shape["to_world"].matrix, float).reshape(4, 4)
    lines = []
    for n, face in enumerate(faces_of(shape["type"])):
        places = face @ matrix[:3, :3].T + matrix[:3, 3] - [0, 0, DISTANCE]
        lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in places]
        lines.append("f " + " ".join(str(4 * n + i) for i in (1, 2, 3, 4)))
    file.write_text("\n".join(lines) + "\n")


def write_scene(scene, folder):
    """The scene file of holotrace, with one OBJ file for each shape; returns it."""
    half_angle = scene["sensor"]["fov"] / 2
    text = [f'wavelength = "532 nm"\n[slm]\npreset = "pluto"\n[render]\nrows = {SIDE}\nfield_of_view = "{half_angle} deg"',
            f"paths = {PATHS}\nmax_depth = {SURFACES}"]
    for name in COLOURS:
        text.append(f"[materials.{name}]\nreflectance = {scene[name]['reflectance']['value']}\ntwo_sided = false")
    for name, shape in scene.items():
        if not isinstance(shape, dict) or shape.get("type") not in ("rectangle", "cube"):
            continue
        write_obj(shape, folder / f"{name}.obj")
        material = shape["bsdf"]["id"]
        if "emitter" in shape:
            emission = shape["emitter"]["radiance"]["value"]
            text.append(f"[materials.{name}]\nreflectance = {scene[material]['reflectance']['value']}\n"
                        f"emission = {emission}\ntwo_sided = false")
            material = name
        text.append(f'[[object]]\ntype = "mesh"\nfile = "{name}.obj"\nscale = 1\nmaterial = "{material}"')
    file = folder / "box.toml"
    file.write_text("\n".join(text) + "\n")
    return file


def render_theirs(scene, seed):
    start = time.process_time()
    picture = np.array(mi.render(scene, spp=PATHS, seed=seed))
    return time.process_time() - start, picture


def render_ours(scene_file, seed):
    used = lambda: sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])  # noqa: E731
    start, output = used(), scene_file.with_name("ours.exr")
    subprocess.run([PROGRAM, "render", scene_file, "-o", output, "--seed", str(seed), "--threads", "1"], check=True)
    seconds = used() - start
    return seconds, np.array(mi.Bitmap(str(output)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32))


def squared_error(pictures):
    return statistics.mean(np.mean((a - b) ** 2) / 2 for a, b in zip(pictures, pictures[1:]))


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    mi.set_variant("llvm_ad_rgb")
    dr.set_thread_count(1)
    description = reference_scene()
    scene = mi.load_dict(description)
    with tempfile.TemporaryDirectory() as folder:
        scene_file = write_scene(description, Path(folder))
        render_theirs(scene, 1000)  # compiles
        theirs, ours = [], []
        for seed in range(1, rounds + 1):
            theirs.append(render_theirs(scene, seed))
            ours.append(render_ours(scene_file, seed))
    found = {}
    for name, runs in (("Mitsuba " + mi.__version__, theirs), ("holotrace", ours)):
        seconds, error = statistics.median(run[0] for run in runs), squared_error([run[1] for run in runs])
        mean = np.mean([run[1] for run in runs])
        found[name] = (seconds, error, mean)
        print(f"  {name:<16} {seconds:6.2f} s of processor time   squared error {error:.3e}   mean {mean:.6f}")
    (time_theirs, error_theirs, mean_theirs), (time_ours, error_ours, mean_ours) = found.values()
    noise = np.sqrt((error_theirs + error_ours) / (rounds * SIDE * SIDE * 3))  # were channels independent
    print(f"  holotrace/Mitsuba: time {time_ours / time_theirs:.2f}, squared error {error_ours / error_theirs:.2f}, "
          f"product {time_ours * error_ours / time_theirs / error_theirs:.2f}")
    print(f"  means differ by {(mean_ours - mean_theirs) / noise:+.1f} standard errors ({mean_ours / mean_theirs - 1:+.2%})")


if __name__ == "__main__":
    main()
