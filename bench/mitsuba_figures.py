#!/usr/bin/env python3
"""Two scenes by Mitsuba 3 and by `holotrace render`: processor time, squared error, and their product.

Usage: mitsuba_figures.py [ROUNDS]     in a Python with Mitsuba (pip install mitsuba; its variant llvm_ad_rgb needs LLVM, such as
                                       libllvm19 of Debian (15 stops on some processors): DRJIT_LIBLLVM_PATH names its libLLVM*.so)

The scenes are the Cornell box of Mitsuba, and a textured mesh of 32,768 triangles on a floor under an even sky and a rectangle.

Both take 64 paths for each of 256 x 256 pixels, box-filtered, of at most 8 surfaces, on one thread, in alternating runs with
other seeds. Mitsuba's sampler is multijitter. Its time is that of mi.render, after its code was compiled by a first run; that of
holotrace is of the whole program, less that of a picture of one path, which loads the scene and builds its trees as well. The squared error of a picture is half the mean squared difference of two, so no reference
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


def as_ours(scene):
    """The scene with a box filter, as the pixels of holotrace are, and Mitsuba's best sampler."""
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


def head_of(scene):
    """The first lines of the scene file of holotrace."""
    half_angle = scene["sensor"]["fov"] / 2
    return [f'wavelength = "532 nm"\n[slm]\npreset = "pluto"\n[render]\nrows = {SIDE}\ncolumns = {SIDE}\nfield_of_view = "{half_angle} deg"',
            f"paths = {PATHS}\nmax_depth = {SURFACES}"]


def cornell_box(folder):
    """Mitsuba's scene, and the scene file of holotrace with one OBJ file for each shape."""
    scene = as_ours(mi.cornell_box())
    text = head_of(scene)
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
    return scene, file


def bumpy_ball(rows=128):
    """Places, normals, texture coordinates and triangles of a ball with bumps, whose radius is about 1."""
    v, u = np.meshgrid(np.linspace(0.001, 0.999, rows + 1), np.linspace(0, 1, rows + 1), indexing="ij")

    def place(u, v):
        polar, turn = np.pi * v, 2 * np.pi * u
        radius = 1 + 0.08 * np.sin(5 * turn) * np.sin(polar) ** 2 * np.sin(6 * polar)
        return radius[..., None] * np.stack([np.sin(polar) * np.cos(turn), np.cos(polar), -np.sin(polar) * np.sin(turn)], -1)

    step = 1e-5
    normals = np.cross(place(u, v + step) - place(u, v - step), place(u + step, v) - place(u - step, v))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    corner = (np.arange(rows)[:, None] * (rows + 1) + np.arange(rows)).ravel()
    faces = np.concatenate([np.stack([corner, corner + rows + 1, corner + 1], -1),
                            np.stack([corner + 1, corner + rows + 1, corner + rows + 2], -1)])
    return place(u, v).reshape(-1, 3), normals.reshape(-1, 3), np.stack([u, v], -1).reshape(-1, 2), faces + 1


def textured_mesh(folder):
    """The same for a textured mesh on a floor. The texture is even about its middle, so that the direction of v does not matter."""
    places, normals, coordinates, faces = bumpy_ball()
    places = places + [0, 0, -5]
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in places] + [f"vt {u:.9g} {v:.9g}" for u, v in coordinates]
    lines += [f"vn {x:.9g} {y:.9g} {z:.9g}" for x, y, z in normals]
    lines += ["f " + " ".join(f"{i}/{i}/{i}" for i in face) for face in faces]
    (folder / "ball.obj").write_text("\n".join(lines) + "\n")
    floor, texture = np.array([[-4, -1.1, -1], [4, -1.1, -1], [4, -1.1, -9], [-4, -1.1, -9]]), folder / "texture.exr"
    (folder / "floor.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in floor) + "f 1 2 3 4\n")
    y, x = np.meshgrid(np.cos(np.linspace(-12, 12, 256)), np.linspace(0, 16 * np.pi, 256, endpoint=False), indexing="ij")
    colours = np.stack([0.5 + 0.3 * np.sin(x) * y, 0.5 + 0.3 * np.sin(x / 2) * y, 0.5 + 0.3 * y], -1)
    mi.Bitmap(colours.astype(np.float32)).write(str(texture))
    at = mi.ScalarTransform4f
    scene = as_ours({
        "type": "scene", "integrator": {"type": "path", "max_depth": SURFACES},
        "sensor": {"type": "perspective", "fov": 40, "to_world": at().look_at([0, 0, 0], [0, 0, -1], [0, 1, 0]),
                   "film": {"type": "hdrfilm", "width": SIDE, "height": SIDE, "component_format": "float32"}},
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": 0.5}},
        "lamp": {"type": "rectangle", "to_world": at().translate([-1.5, 2.5, -4]).rotate([1, 0, 0], 90).scale(0.5),
                 "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}},
                 "emitter": {"type": "area", "radiance": {"type": "rgb", "value": 8.0}}},
        "ball": {"type": "obj", "filename": str(folder / "ball.obj"),
                 "bsdf": {"type": "diffuse", "reflectance": {"type": "bitmap", "filename": str(texture), "raw": True}}},
        "floor": {"type": "obj", "filename": str(folder / "floor.obj"), "face_normals": True,
                  "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.6}}},
    })
    text = head_of(scene) + [
        '[materials.ball]\ntexture = "texture.exr"', "[materials.floor]\nreflectance = 0.6",
        '[[object]]\ntype = "mesh"\nfile = "ball.obj"\nscale = 1\nmaterial = "ball"',
        '[[object]]\ntype = "mesh"\nfile = "floor.obj"\nscale = 1\nmaterial = "floor"',
        '[[light]]\ntype = "rectangle"\ncorner = "-2 2.5 -4.5 m"\nedge_u = "1 0 0 m"\nedge_v = "0 0 1 m"\nradiance = 8.0']
    file = folder / "mesh.toml"
    file.write_text("\n".join(["background = 0.5", *text]) + "\n")
    return scene, file


def render_theirs(scene, seed):
    dr.set_thread_count(1)
    start = time.process_time()
    picture = np.array(mi.render(scene, spp=PATHS, seed=seed))
    seconds = time.process_time() - start
    dr.set_thread_count(2)  # Mitsuba's EXR files wait for a second thread
    return seconds, picture


def render_ours(scene_file, seed):
    """Seconds of a picture, less those of one of a single path, and the picture."""
    seconds, picture = run_ours(scene_file, ["--seed", str(seed)])
    return seconds - run_ours(scene_file, ["--rows", "1", "--columns", "1", "--paths", "1"])[0], picture


def run_ours(scene_file, flags):
    used = lambda: sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])  # noqa: E731
    start, output = used(), scene_file.with_name("ours.exr")
    subprocess.run([PROGRAM, "render", scene_file, "-o", output, "--threads", "1", *flags], check=True)
    seconds = used() - start
    return seconds, np.array(mi.Bitmap(str(output)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32))


def squared_error(pictures):
    return statistics.mean(np.mean((a - b) ** 2) / 2 for a, b in zip(pictures, pictures[1:]))


def compare(name, description, scene_file, rounds):
    """Alternating runs of both programs, and a table of what they took and gave."""
    scene = mi.load_dict(description)
    render_theirs(scene, 1000)  # compiles
    theirs, ours = [], []
    for seed in range(1, rounds + 1):
        theirs.append(render_theirs(scene, seed))
        ours.append(render_ours(scene_file, seed))
    found = {}
    print(name)
    for program, runs in (("Mitsuba " + mi.__version__, theirs), ("holotrace", ours)):
        seconds, error = statistics.median(run[0] for run in runs), squared_error([run[1] for run in runs])
        mean = np.mean([run[1] for run in runs])
        found[program] = (seconds, error, mean)
        print(f"  {program:<16} {seconds:6.2f} s of processor time   squared error {error:.3e}   mean {mean:.6f}")
    (time_theirs, error_theirs, mean_theirs), (time_ours, error_ours, mean_ours) = found.values()
    noise = np.sqrt((error_theirs + error_ours) / (rounds * SIDE * SIDE * 3))  # were channels independent
    print(f"  holotrace/Mitsuba: time {time_ours / time_theirs:.2f}, squared error {error_ours / error_theirs:.2f}, "
          f"product {time_ours * error_ours / time_theirs / error_theirs:.2f}")
    print(f"  means differ by {(mean_ours - mean_theirs) / noise:+.1f} standard errors ({mean_ours / mean_theirs - 1:+.2%})")


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    mi.set_variant("llvm_ad_rgb")
    for make in (cornell_box, textured_mesh):
        with tempfile.TemporaryDirectory() as folder:
            compare(make.__name__.replace("_", " "), *make(Path(folder)), rounds)


if __name__ == "__main__":
    main()
