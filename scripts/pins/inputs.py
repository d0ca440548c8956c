"""The files that the jobs read: scenes and panels of `inputs/`, the examples in small, and pictures, fields and points."""
import json
import math
import pathlib
import shutil
import struct
import zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
EXAMPLES = ROOT / "examples"
WIDTH, HEIGHT = 160, 120  # of panel.toml

# An example with a small panel and few rays; the camera still sees the whole scene.
SMALL = """extends = "../examples/{name}.toml"

[slm]
columns = {columns}
rows = {rows}

[trace]
columns = {columns}
rows = {rows}
samples = 3000
pixel_samples = 8
paths = 2
frames = {frames}

[render]
columns = 64
rows = 36
paths = 2
denoise = "none"

[encode]
iterations = 6
planes = 3
denoise = "none"

[camera]
binning = 1
width = "{width} mm"
height = "{height} mm"
pixel = "60 um"
"""
# Models whose first byte is not theirs: it tells the fuzz target which format it is.
MODELS = {"3ds": "model.3ds", "dae": "model.dae", "off": "model.off", "stl": "text.stl", "stl_binary": "binary.stl"}
FRAMES = {"chess_frames": 2, "chess_light_field": 2, "chess_optimised": 2, "chess_photoreal": 2, "oblique_mirror": 2,
          "parallax": 2}


def png(width, height, rows, colour=0):
    """A PNG of 8 bits; rows: bytes of each row; colour: 0 for grey, 2 for RGB."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, colour, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(b"".join(b"\0" + bytes(row) for row in rows))) + chunk(b"IEND", b""))


def grey(width, height, value):
    return png(width, height, ([value(i, j) for i in range(width)] for j in range(height)))


def colours(width, height):
    rows = ([(i * step + j * 5) % 256 for i in range(width) for step in (3, 11, 23)] for j in range(height))
    return png(width, height, rows, 2)


def field_file(columns, rows, is_fortran=False):
    """A lens of complex128 as NumPy saves it; is_fortran: column by column."""
    head = f"{{'descr': '<c16', 'fortran_order': {is_fortran}, 'shape': ({rows}, {columns}), }}".encode()
    head += b" " * (64 - (len(head) + 11) % 64) + b"\n"
    places = [(i, j) for i in range(columns) for j in range(rows)] if is_fortran else [
        (i, j) for j in range(rows) for i in range(columns)]
    phases = (0.002 * (i - 70) ** 2 + 0.003 * (j - 60) ** 2 for i, j in places)
    samples = b"".join(struct.pack("<2d", math.cos(phase), math.sin(phase)) for phase in phases)
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + samples


# All that a field can say of itself.
LABELS = {"pitch_m": 8e-6, "wavelengths_m": [638e-9], "z_m": 0, "image": "real", "name": "EDL", "frame": 2,
          "cone_wavelength_m": 450e-9}
FILTER = {"u0_per_m": 1000, "v0_per_m": -2000, "half_u_per_m": 30000, "half_v_per_m": 25000}


def points():
    lines = ["ply", "format ascii 1.0", "element vertex 40", "property float x", "property float y", "property float z",
             "property uchar red", "property uchar green", "property uchar blue", "end_header"]
    lines += [f"{0.4 * math.cos(i):.6f} {0.3 * math.sin(2 * i):.6f} {0.01 * i:.6f} {255 - 5 * i} {6 * i} 128" for i in range(40)]
    return "\n".join(lines) + "\n"


def write_inputs(folder):
    """Writes all of them into a folder."""
    shutil.copytree(pathlib.Path(__file__).parent / "inputs", folder)
    shutil.copytree(EXAMPLES, folder / "examples")
    shutil.copytree(ROOT / "tests" / "data_files", folder / "data", ignore=shutil.ignore_patterns("*.py", "*.md"))
    for name in ("seeds", "small"):
        (folder / name).mkdir()
    seeds = ROOT / "fuzz" / "seeds"
    for seed, name in MODELS.items():
        (folder / "seeds" / name).write_bytes((seeds / "assimp" / seed).read_bytes()[1:])
    for name in ("field", "stack"):
        shutil.copy(seeds / "hdf5" / name, folder / "seeds" / f"{name}.h5")
    for example in sorted(EXAMPLES.glob("*.toml")):
        name = example.stem
        columns, rows = (32, 32) if name == "paper_steps" else (192, 108)  # it follows a path from each pixel and ray
        width = 3 if name == "fig10_chess_overlap" else 9  # it has 9 samples for each pixel
        (folder / "small" / example.name).write_text(SMALL.format(
            name=name, columns=columns, rows=rows, frames=FRAMES.get(name, 1), width=width, height=width * 2 / 3))
    (folder / "picture.png").write_bytes(colours(96, 72))
    (folder / "depth.png").write_bytes(grey(24, 16, lambda i, j: 10 * i))
    (folder / "sky.png").write_bytes(colours(16, 8))
    (folder / "grey.png").write_bytes(grey(WIDTH, HEIGHT, lambda i, j: (7 * i + 3 * j) % 256))
    (folder / "phase_map.png").write_bytes(grey(WIDTH, HEIGHT, lambda i, j: (i * i + j) // 110))
    (folder / "light_map.png").write_bytes(grey(WIDTH, HEIGHT, lambda i, j: 255 - abs(i - 80)))
    (folder / "calibration.csv").write_text("level,phase_pi,amplitude\n0,0,1\n30,0.9,0.97\n63,2.1,0.99\n")
    (folder / "points.ply").write_text(points())
    (folder / "foreign.npy").write_bytes(field_file(48, 32, is_fortran=True))
    (folder / "foreign.json").write_text('{"pitch_m": 8e-6, "wavelengths_m": [532e-9], "z_m": 0}\n')  # the first form of the name
    (folder / "labelled.npy").write_bytes(field_file(WIDTH, HEIGHT))
    (folder / "labelled.npy.json").write_text(json.dumps(LABELS))
    (folder / "filtered.npy").write_bytes(field_file(WIDTH, HEIGHT))
    (folder / "filtered.npy.json").write_text(json.dumps({**LABELS, "centre_x_m": 1e-4, "centre_y_m": -2e-4, "filter": FILTER}))
