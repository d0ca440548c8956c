#!/usr/bin/env python3
"""Writes the models and pictures beside this script: no code of Holotrace makes them. Those of pictures/ come from Pillow,
the rest from the standard library alone.

    python3 tests/data_files/make_data.py

What each holds is said in README.md; tests of io/ and end_to_end/ know the numbers.
"""
import json
import math
import os
import struct
import zlib

FOLDER = os.path.dirname(os.path.abspath(__file__))


def save(name, data):
    with open(os.path.join(FOLDER, name), "wb") as file:
        file.write(data if isinstance(data, bytes) else data.encode())


# --- a picture ------------------------------------------------------------------------------------


def paeth(left, above, corner):
    """The PNG specification's predictor: whichever neighbour is nearest to left + above - corner."""
    guess = left + above - corner
    return min((left, above, corner), key=lambda value: abs(guess - value))


def png(width, height, pixel):
    """An 8-bit RGB PNG; its rows take the five filters in turn, its data lies in several IDAT chunks."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows, above = b"", bytes(3 * width)
    for j in range(height):
        row = bytes(value for i in range(width) for value in pixel(i, j))
        left, corner = bytes(3) + row[:-3], bytes(3) + above[:-3]
        predicted = [
            bytes(3 * width),
            left,
            above,
            bytes((a + b) // 2 for a, b in zip(left, above)),
            bytes(paeth(a, b, c) for a, b, c in zip(left, above, corner)),
        ][j % 5]
        rows += bytes([j % 5]) + bytes((a - b) % 256 for a, b in zip(row, predicted))
        above = row
    data, part = zlib.compress(rows, 9), 400
    chunks = b"".join(chunk(b"IDAT", data[k : k + part]) for k in range(0, len(data), part))
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + chunk(b"sRGB", b"\0") + chunks + chunk(b"IEND", b"")


def exr(width, height, pixel):
    """An uncompressed EXR of 16-bit floats, with the attributes that the format asks for."""

    def attribute(name, kind, value):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(value)) + value

    names = b"BGR"  # in alphabetical order, as the format asks
    channels = b"".join(bytes([name]) + b"\0" + struct.pack("<IBBBBII", 1, 0, 0, 0, 0, 1, 1) for name in names) + b"\0"
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = b"\x76\x2f\x31\x01\x02\0\0\0" + attribute(b"channels", b"chlist", channels)
    header += attribute(b"compression", b"compression", b"\0")
    header += attribute(b"dataWindow", b"box2i", box) + attribute(b"displayWindow", b"box2i", box)
    header += attribute(b"lineOrder", b"lineOrder", b"\0") + attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    header += attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0))
    header += attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0"
    rows, table = b"", b""
    for j in range(height):
        data = b"".join(struct.pack("<e", pixel(i, j)["RGB".index(chr(name))]) for name in names for i in range(width))
        table += struct.pack("<Q", len(header) + 8 * height + len(rows))
        rows += struct.pack("<iI", j, len(data)) + data
    return header + table + rows


def hdr(width, height, pixel):
    """A Radiance picture in runs: mantissas of the colours and the exponent 136, so that the values are the mantissas."""
    data = b""
    for j in range(height):
        row = [pixel(i, j) for i in range(width)]
        data += bytes([2, 2, width >> 8, width & 255])
        for c in range(3):
            data += bytes([width]) + bytes(colour[c] for colour in row)  # as they are
        data += bytes([128 + width, 136])  # a run
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width) + data


def pictures():
    """The same 24 x 16 colours in every format that is read; grey ones have the red alone."""
    from PIL import Image

    def colour(i, j):
        return i * 11, j * 17, (i * 7 + j * 13) % 256

    folder, size = os.path.join(FOLDER, "pictures"), (24, 16)
    os.makedirs(folder, exist_ok=True)
    rgb = Image.new("RGB", size)
    rgb.putdata([colour(i, j) for j in range(size[1]) for i in range(size[0])])
    red = rgb.getchannel(0)
    rgba = rgb.copy()
    rgba.putalpha(rgb.getchannel(2))
    for name, picture, options in (
        ("rgb.jpg", rgb, {"quality": 100, "subsampling": 0}), ("progressive.jpg", rgb, {"quality": 100, "subsampling": 0, "progressive": True}),
        ("grey.jpg", red, {"quality": 100}), ("cmyk.jpg", rgb.convert("CMYK"), {"quality": 100, "subsampling": 0}),
        ("rgb.tif", rgb, {"compression": "tiff_lzw"}), ("rgba.tif", rgba, {}), ("grey.tif", red, {"compression": "tiff_adobe_deflate"}),
        ("grey16.tif", Image.frombytes("I;16", size, b"".join(struct.pack("<H", 257 * v) for v in red.tobytes())), {}),
        ("rgba.webp", rgba, {"lossless": True, "exact": True}), ("rgb.bmp", rgb, {}), ("grey.bmp", red, {}), ("rgb.tga", rgb, {}),
        ("runs.tga", rgb, {"compression": "tga_rle"}), ("rgba.tga", rgba, {"orientation": 1}), ("grey.tga", red, {"compression": "tga_rle"}),
        ("palette.png", red.convert("P"), {}), ("rgba.png", rgba, {}),
    ):
        picture.save(os.path.join(folder, name), **options)
    save("pictures/rgb.exr", exr(*size, colour))
    save("pictures/rgb.hdr", hdr(*size, colour))


def rooms(size):
    """Four by four rooms of four shades, none like its neighbours, as tests/end_to_end/test_recognisable.cpp."""
    shades = (63, 255, 160, 217)  # sRGB of 0.05, 1, 0.35, 0.7

    def pixel(i, j):
        a, b = 4 * i // size, 4 * j // size
        return (shades[(a + 2 * b + b // 2) % 4],) * 3

    return pixel


# --- OBJ ------------------------------------------------------------------------------------------


def torus(major=2.0, minor=0.5, around=24, across=12):
    """A ring about the y axis of quads, with texture coordinates (v up), normals and a material with a texture."""
    text = "# a torus of radii 2 and 0.5 about the y axis\nmtllib torus.mtl\no torus\nusemtl checks\n"
    for i in range(around):
        for j in range(across):
            a, b = 2 * math.pi * i / around, 2 * math.pi * j / across
            r = major + minor * math.cos(b)
            text += f"v {r * math.cos(a):.6f} {minor * math.sin(b):.6f} {-r * math.sin(a):.6f}\n"
            text += f"vn {math.cos(b) * math.cos(a):.6f} {math.sin(b):.6f} {-math.cos(b) * math.sin(a):.6f}\n"
    for i in range(around + 1):
        for j in range(across + 1):
            text += f"vt {i / around:.6f} {j / across:.6f}\n"
    for i in range(around):
        for j in range(across):
            corners = []
            for k, l in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                place = k % around * across + l % across + 1
                corners.append(f"{place}/{k * (across + 1) + l + 1}/{place}")
            text += "f " + " ".join(corners) + "\n"
    return text


def pebble():
    """An icosahedron divided twice, its corners on a bumpy ball: as a scan, without normals, groups or materials."""
    golden = (1 + math.sqrt(5)) / 2
    corners = [(0, a, b * golden) for a in (-1, 1) for b in (-1, 1)]
    corners = [p[k:] + p[:k] for k in range(3) for p in corners]
    near = [
        [k for k in range(12) if abs(math.dist(corners[i], corners[k]) - 2) < 1e-9] for i in range(12)
    ]  # edges are 2 long
    faces = [(i, j, k) for i in range(12) for j in near[i] for k in near[i] if i < j < k and k in near[j]]

    def outward(face):
        a, b, c = (corners[i] for i in face)
        n = [
            (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]),
            (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]),
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]),
        ]
        return face if sum(x * y for x, y in zip(n, a)) > 0 else (face[0], face[2], face[1])

    faces = [outward(face) for face in faces]
    for _ in range(2):
        middles, finer = {}, []

        def middle(i, j):
            key = (min(i, j), max(i, j))
            if key not in middles:
                middles[key] = len(corners)
                corners.append(tuple((x + y) / 2 for x, y in zip(corners[i], corners[j])))
            return middles[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = finer
    text = ""
    for p in corners:
        x, y, z = (value / math.dist(p, (0, 0, 0)) for value in p)
        r = 1 + 0.15 * math.sin(3 * x) * math.cos(2 * y + z)
        text += f"v {r * x:.6f} {r * y:.6f} {r * z:.6f}\n"
    return text + "".join("f {} {} {}\n".format(*(i + 1 for i in face)) for face in faces)


def lampshade(around=12):
    """An open cone of quads, every other one wound the other way, and a hexagon on top: surfaces with two sides."""
    text = "g shade\n"
    for y, r in ((0, 2), (1.5, 1)):
        for i in range(around):
            a = 2 * math.pi * i / around
            text += f"v {r * math.cos(a):.6f} {y} {r * math.sin(a):.6f}\n"
    for i in range(around):
        n = (i + 1) % around
        corners = [i + 1, n + 1, around + n + 1, around + i + 1]
        text += "f " + " ".join(map(str, corners if i % 2 else corners[::-1])) + "\n"
    text += "g top\nf " + " ".join(str(i - 2 * around) for i in range(around, 2 * around, 2)) + "\n"  # from the end
    return text


# --- glTF -----------------------------------------------------------------------------------------


class Gltf:
    """A binary glTF 2.0 in the making."""

    def __init__(self):
        self.data, self.views, self.accessors = b"", [], []

    def view(self, data):
        self.data += bytes(-len(self.data) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)})
        self.data += data
        return len(self.views) - 1

    def accessor(self, rows, kind):
        """Rows of floats, or indices as 16-bit numbers for the kind SCALAR."""
        values = [value for row in rows for value in (row if isinstance(row, tuple) else (row,))]
        is_index = kind == "SCALAR"
        entry = {
            "bufferView": self.view(struct.pack(f"<{len(values)}{'H' if is_index else 'f'}", *values)),
            "componentType": 5123 if is_index else 5126,
            "count": len(rows),
            "type": kind,
        }
        if kind == "VEC3":
            entry["min"] = [min(row[k] for row in rows) for k in range(3)]
            entry["max"] = [max(row[k] for row in rows) for k in range(3)]
        self.accessors.append(entry)
        return len(self.accessors) - 1

    def primitive(self, positions, triangles, material, **attributes):
        entry = {"attributes": {"POSITION": self.accessor(positions, "VEC3")}, "material": material}
        for name, rows in attributes.items():
            entry["attributes"][name] = self.accessor(rows, "VEC2" if name.startswith("TEXCOORD") else "VEC3")
        entry["indices"] = self.accessor([k for t in triangles for k in t], "SCALAR")
        return entry

    def save(self, name, **members):
        document = {
            "asset": {"version": "2.0", "generator": "make_data.py of Holotrace"},
            "scene": 0,
            "accessors": self.accessors,
            "bufferViews": self.views,
            **members,
        }
        self.data += bytes(-len(self.data) % 4)
        document["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        size = 12 + 8 + len(text) + 8 + len(self.data)
        header = b"glTF" + struct.pack("<II", 2, size) + struct.pack("<I", len(text)) + b"JSON"
        save(name, header + text + struct.pack("<I", len(self.data)) + b"BIN\0" + self.data)


def box(size, centre=(0, 0, 0)):
    """Positions, normals, texture coordinates (v down) and triangles of a box, four corners to each face."""
    positions, normals, places, triangles = [], [], [], []
    for axis in range(3):
        for side in (-1, 1):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            first = len(positions)
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                p = [0.0] * 3
                p[axis], p[u], p[v] = side, a, b
                positions.append(tuple(centre[k] + p[k] * size[k] / 2 for k in range(3)))
                normals.append(tuple(float(side) if k == axis else 0.0 for k in range(3)))
                places.append(((1 + side * a) / 2, (1 - b) / 2))
            order = (0, 1, 2, 0, 2, 3) if side > 0 else (0, 2, 1, 0, 3, 2)
            triangles += [tuple(first + k for k in order[:3]), tuple(first + k for k in order[3:])]
    return positions, normals, places, triangles


def textured_box():
    """A cube of side 1 under a node that turns z up into y up, with its texture inside."""
    gltf = Gltf()
    positions, normals, places, triangles = box((1, 1, 1))
    primitive = gltf.primitive(positions, triangles, 0, NORMAL=normals, TEXCOORD_0=places)
    picture = gltf.view(png(60, 60, rooms(60)))
    gltf.save(
        "textured_box.glb",
        scenes=[{"nodes": [0]}],
        nodes=[{"children": [1], "matrix": [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1]}, {"mesh": 0}],
        meshes=[{"name": "box", "primitives": [primitive]}],
        materials=[{"name": "rooms", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0}}],
        textures=[{"source": 0, "sampler": 0}],
        samplers=[{"magFilter": 9729, "wrapS": 10497, "wrapT": 10497}],
        images=[{"bufferView": picture, "mimeType": "image/png"}],
    )


def pump():
    """Two pistons, one mesh of two materials placed twice by nodes in nodes, on a base; and a camera."""
    gltf = Gltf()

    def part(size, centre, material):
        positions, normals, _, triangles = box(size, centre)
        return gltf.primitive(positions, triangles, material, NORMAL=normals)

    piston = [part((2, 3, 1), (0, 1.5, 0), 0), part((0.5, 4, 0.5), (0, -2, 0), 1)]
    base = [part((8, 1, 4), (0, -4.5, 0), 2)]
    half = math.sqrt(0.5)
    gltf.save(
        "pump.glb",
        scenes=[{"nodes": [0, 4]}],
        nodes=[
            {"children": [1, 2, 3], "scale": [10, 10, 10], "translation": [100, 0, 0]},
            {"mesh": 0, "translation": [-2, 0, 0]},
            {"mesh": 0, "translation": [2, 1, 0], "rotation": [0, half, 0, half]},  # a quarter turn about y
            {"mesh": 1},
            {"camera": 0, "translation": [100, 0, 200]},
        ],
        meshes=[{"name": "piston", "primitives": piston}, {"name": "base", "primitives": base}],
        materials=[
            {"name": "head", "pbrMetallicRoughness": {"baseColorFactor": [0.85, 0.85, 0.85, 1], "metallicFactor": 0}},
            {"name": "rod", "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0.5}},
            {"name": "base", "pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.45, 0.1, 1], "metallicFactor": 0}},
        ],
        cameras=[{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 1}}],
    )


# --- PLY in the dialect of the OpenHolo library ---------------------------------------------------


def helix(count=500):
    """Points on a helix with 8-bit colours and a phase, behind an element `color` of one row."""
    text = (
        "ply\nformat ascii 1.0\ncomment points on a helix, in the dialect of OpenHolo\n"
        "element color 1\nproperty int channel\n"
        f"element vertex {count}\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty double phase\nend_header\n3\n"
    )
    for k in range(count):
        t = k / (count - 1)
        a = 8 * math.pi * t
        text += f"{math.cos(a) / 2:.6f} {t - 0.5:.6f} {math.sin(a) / 2:.6f} "
        text += f"{round(255 * t)} {round(255 * (1 - t))} {k % 256} {2 * math.pi * t:.6f}\n"
    return text


def soup():
    """The faces of an octahedron as loose corners in threes, each with the number of its face."""
    tips = [(s, 0, 0) for s in (1, -1)], [(0, s, 0) for s in (1, -1)], [(0, 0, s) for s in (1, -1)]
    rows = []
    for a in tips[0]:
        for b in tips[1]:
            for c in tips[2]:
                turn = a[0] * b[1] * c[2] > 0
                for p in (a, b, c) if turn else (a, c, b):
                    rows.append(f"{len(rows) // 3} {p[0]:.6f} {p[1]:.6f} {p[2]:.6f} 200 120 40\n")
    return (
        "ply\nformat ascii 1.0\ncomment an octahedron as loose triangles, in the dialect of OpenHolo\n"
        f"element color 1\nproperty int channel\nelement vertex {len(rows)}\nproperty uint face_idx\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n3\n" + "".join(rows)
    )


def main():
    save("ramp.png", png(96, 64, lambda i, j: (i * 255 // 95, j * 255 // 63, (i * 7 + j * 13) % 256)))
    save("torus.obj", torus())
    save("torus.mtl", "newmtl checks\nKd 1 1 1\nmap_Kd ramp.png\n")
    save("pebble.obj", pebble())
    save("lampshade.obj", lampshade())
    textured_box()
    pump()
    save("helix_points.ply", helix())
    save("soup.ply", soup())
    pictures()


main()
