#!/usr/bin/env python3
"""Media, absorbing glass, metals and veils by Mitsuba 3 and by `holotrace render`: regions of their pictures.

Usage: mitsuba_regions.py [--paths N] [SCENE…]     in a Python with Mitsuba, as ../mitsuba_figures.py says

Each scene is rendered twice by each program, at 64 x 64 pixels. Printed are, over 4 x 4 regions and three colours, the largest and the
rms difference of the programs, and the rms of the noise that two runs of each leave in that difference.

Not compared, as the models differ: Mitsuba's `principled` with a dielectric base (its diffuse part is Burley's), `sunsky` (Hosek and Wilkie;
holotrace has Preetham's sky), `measured` (no file of the database at hand), and emission of media by temperature.
"""

import argparse
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import mitsuba as mi

PROGRAM = Path(os.environ.get("HOLOTRACE", Path(__file__).resolve().parents[2] / "build" / "release" / "holotrace"))
SIDE, REGIONS, HALF_ANGLE = 64, 4, 20
mi.set_variant("llvm_ad_rgb")
at = mi.ScalarTransform4f


def rgb(*value):
    return {"type": "rgb", "value": list(value) if len(value) > 1 else value[0]}


def diffuse(*value):
    return {"type": "diffuse", "reflectance": rgb(*value)}


def quad(centre, width, depth, bsdf, turn=-90, emitter=None):
    """A horizontal rectangle that faces up, or one turned about x by another angle from facing the camera."""
    shape = {"type": "rectangle", "to_world": at().translate(centre).rotate([1, 0, 0], turn).scale([width / 2, depth / 2, 1]), "bsdf": bsdf}
    if emitter:
        shape["emitter"] = {"type": "area", "radiance": rgb(*emitter)}
    return shape


def frame(depth, **content):
    """A floor, a wall and a lamp above, which both programs see from the origin along -z; the lamp faces down."""
    return {
        "type": "scene", "integrator": {"type": "volpath", "max_depth": depth, "rr_depth": 1000},
        "sensor": {"type": "perspective", "fov": 2 * HALF_ANGLE, "to_world": at().look_at([0, 0, 0], [0, 0, -1], [0, 1, 0]),
                   "film": {"type": "hdrfilm", "width": SIDE, "height": SIDE, "rfilter": {"type": "box"}, "component_format": "float32"}},
        "floor": quad([0, -1, -4], 8, 8, diffuse(0.5, 0.4, 0.3)), "wall": quad([0, 1, -6], 8, 4, diffuse(0.3, 0.4, 0.5), 0),
        "lamp": quad([0, 2.4, -4], 2, 2, diffuse(0.0), 90, (8, 8, 8)), **content}


def ours(depth, text):
    return f"""wavelength = "532 nm"
[slm]
preset = "pluto"
[render]
rows = {SIDE}
columns = {SIDE}
field_of_view = "{HALF_ANGLE} deg"
max_depth = {depth}
roulette_depth = 1000
[materials.floor]
reflectance = [0.5, 0.4, 0.3]
[materials.wall]
reflectance = [0.3, 0.4, 0.5]
[materials.lamp]
reflectance = 0
emission = 8
two_sided = false
[[object]]
type = "quad"
width = "8 m"
height = "8 m"
rotation = "x -90 deg"
position = "0 -1 -4 m"
material = "floor"
[[object]]
type = "quad"
width = "8 m"
height = "4 m"
position = "0 1 -6 m"
material = "wall"
[[object]]
type = "quad"
width = "2 m"
height = "2 m"
rotation = "x 90 deg"
position = "0 2.4 -4 m"
material = "lamp"
{text}"""


def cube(**content):
    return {"type": "cube", "to_world": at().translate([0, 0, -4]).scale(0.7), **content}


BOX = '[[object]]\ntype = "box"\nsize = "1.4 1.4 1.4 m"\nposition = "0 0 -4 m"\nmaterial = "box"\n'


def fog(folder):
    """A cube of even fog, coloured, without a surface."""
    extinction, albedo = (1.0, 1.5, 2.0), (0.9, 0.8, 0.7)
    medium = {"type": "homogeneous", "sigma_t": rgb(*[e / 2 for e in extinction]), "scale": 2.0, "albedo": rgb(*albedo), "phase": {"type": "hg", "g": 0.4}}
    paths = ", ".join(f"{1 / e} m" for e in extinction)
    theirs = frame(64, box=cube(bsdf={"type": "null"}, interior=medium))
    theirs["integrator"]["type"] = "volpathmis"
    return theirs, ours(64, f'[media.fog]\nmean_free_path = "{paths}"\nalbedo = {list(albedo)}\nanisotropy = 0.4\n'
                        f'[materials.box]\ntype = "interface"\nmedium = "fog"\n{BOX}')


def smoke(folder):
    """A cube of smoke with a grid of densities."""
    z, y, x = np.meshgrid(*[(np.arange(n) + 0.5) / n for n in (12, 16, 10)], indexing="ij")
    density = (np.clip(1.1 - 2 * np.hypot(x - 0.5, z - 0.5), 0, None) * (1.5 - y) * (1 + 0.5 * np.sin(20 * y))).astype(np.float32)
    np.save(folder / "smoke.npy", density)
    grid = {"type": "gridvolume", "grid": mi.VolumeGrid(density[..., None]), "to_world": at().translate([-0.7, -0.7, -4.7]).scale(1.4),
            "filter_type": "trilinear", "wrap_mode": "clamp", "raw": True}
    medium = {"type": "heterogeneous", "sigma_t": grid, "scale": 3.0, "albedo": rgb(0.85), "phase": {"type": "isotropic"}}
    return frame(64, box=cube(bsdf={"type": "null"}, interior=medium)), ours(
        64, '[media.smoke]\nmean_free_path = "0.333333333 m"\nalbedo = 0.85\nbox = ["-0.7 -0.7 -4.7 m", "0.7 0.7 -3.3 m"]\ndensity = "smoke.npy"\n')


def glass(folder):
    """A cube of absorbing glass that stands on the floor."""
    colour = (0.3, 0.6, 0.9)  # after 1 m
    medium = {"type": "homogeneous", "sigma_t": rgb(*[-float(np.log(c)) / 2 for c in colour]), "scale": 2.0, "albedo": rgb(0.0)}
    theirs = frame(16, box=cube(bsdf={"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}, interior=medium))
    theirs["integrator"]["type"] = "volpathmis"
    return theirs, ours(16, '[materials.box]\ntype = "principled"\nroughness = 0\ntransmission = 1\nbase_color = 1\nindex = 1.5\n'
                        f'attenuation_color = {list(colour)}\nattenuation_distance = "1 m"\n{BOX}')


def metal(folder):
    """A cube of a coloured metal under an even sky. At a roughness of 0.2 Mitsuba's single scattering loses less than 0.3 % of the light, which
    holotrace gives back; more of it would be seen in regions that are dark."""
    bsdf = {"type": "principled", "base_color": rgb(0.9, 0.6, 0.3), "metallic": 1.0, "roughness": 0.2, "specular": 0.5}
    sky = {"type": "constant", "radiance": rgb(0.5)}
    return frame(8, box=cube(bsdf=bsdf), sky=sky), "background = 0.5\n" + ours(
        8, f'[materials.box]\ntype = "principled"\nbase_color = [0.9, 0.6, 0.3]\nmetalness = 1\nroughness = 0.2\n{BOX}')


def veil(folder):
    """A diffuse cube of the opacity 0.4."""
    bsdf = {"type": "mask", "opacity": 0.4, "bsdf": {"type": "twosided", "bsdf": diffuse(0.7, 0.5, 0.6)}}
    return frame(16, box=cube(bsdf=bsdf)), ours(16, f'[materials.box]\nreflectance = [0.7, 0.5, 0.6]\nopacity = 0.4\n{BOX}')


SCENES = {make.__name__: make for make in (fog, smoke, glass, metal, veil)}


def regions(picture):
    return picture.reshape(REGIONS, SIDE // REGIONS, REGIONS, SIDE // REGIONS, 3).mean((1, 3))


def compare(name, paths):
    with tempfile.TemporaryDirectory() as folder:
        theirs, text = SCENES[name](Path(folder))
        file, output = Path(folder) / "scene.toml", Path(folder) / "ours.exr"
        file.write_text(text)
        scene, found = mi.load_dict(theirs), {"theirs": [], "ours": []}
        for seed in (1, 2):
            found["theirs"].append(regions(np.array(mi.render(scene, spp=paths, seed=seed))))
            subprocess.run([PROGRAM, "render", file, "-o", output, "--paths", str(paths), "--seed", str(seed)], check=True)
            found["ours"].append(regions(np.array(mi.Bitmap(str(output)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32))))
    mean = {program: np.mean(pictures, 0) for program, pictures in found.items()}
    difference = mean["ours"] / mean["theirs"] - 1
    noise = np.sqrt(sum(np.mean((a / b - 1) ** 2) / 4 for a, b in found.values()))  # a mean of two has half the variance of a/b - 1, over 2
    rms = np.sqrt(np.mean(difference**2))
    print(f"{name:<6} largest {np.abs(difference).max():.2%}   rms {rms:.2%}   noise {noise:.2%}   whole picture {mean['ours'].mean() / mean['theirs'].mean() - 1:+.2%}",
          flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--paths", type=int, default=4096, help="paths for each pixel")
    parser.add_argument("scenes", nargs="*", default=list(SCENES), metavar="SCENE", help=", ".join(SCENES))
    arguments = parser.parse_args()
    for name in arguments.scenes:
        compare(name, arguments.paths)


if __name__ == "__main__":
    main()
