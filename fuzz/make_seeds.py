#!/usr/bin/env python3
"""Writes the seeds of the fuzz targets, fuzz/seeds/TARGET/: small valid files of each kind, from which libFuzzer
makes damaged ones. The seeds of hdf5 were made by the program (`field`) and by h5py (`chunks`, `stack`), those of JPEG and WebP by Pillow."""
import base64
import json
import pathlib
import struct
import zlib

HERE = pathlib.Path(__file__).resolve().parent
DATA = HERE.parent / "tests" / "data_files"
LINE = b"\n#####\n"  # divides an input into two files (reader.h)


def seed(target, name, content):
    folder = HERE / "seeds" / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)


def png(width, height, channels, bits, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, bits, {1: 0, 2: 4, 3: 2, 4: 6}[channels], 0, 0, 0)
    raw = b"".join(b"\0" + row for row in rows)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b"")


def exr(names, width, height, compression, attributes=b""):
    def attribute(name, kind, value):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(value)) + value

    channels = b"".join(n + b"\0" + struct.pack("<IBBBBII", 2, 0, 0, 0, 0, 1, 1) for n in sorted(names)) + b"\0"
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = b"\x76\x2f\x31\x01\x02\0\0\0"
    header += attribute(b"channels", b"chlist", channels)
    header += attribute(b"compression", b"compression", bytes([compression]))
    header += attribute(b"dataWindow", b"box2i", box) + attribute(b"displayWindow", b"box2i", box)
    header += attribute(b"lineOrder", b"lineOrder", b"\0")
    header += attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    header += attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0))
    header += attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1))
    for name, value in ((b"pitch_m", 8e-6), (b"wavelengths_m", 532e-9)):
        header += attribute(name, b"double", struct.pack("<d", value))
    header += b"\0"
    rows, table, at = b"", b"", len(header) + 8 * height
    for y in range(height):
        data = struct.pack(f"<{width * len(names)}f", *[0.5] * (width * len(names)))
        row = struct.pack("<iI", y, len(data)) + data
        table += struct.pack("<Q", at)
        at += len(row)
        rows += row
    return header + table + rows


def gltf(**changes):
    data = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<6f", 0, 0, 1, 0, 0, 1) + struct.pack("<3I", 0, 1, 2)
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1], "scale": [1, 2, 3]}, {"mesh": 0, "rotation": [0, 0, 0, 1], "translation": [1, 2, 3]}],
        "meshes": [{"name": "m", "primitives": [
            {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0, "mode": 4}]}],
        "materials": [{"name": "a", "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1], "metallicFactor": 0}}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
                      {"bufferView": 2, "componentType": 5125, "count": 3, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24},
                        {"buffer": 0, "byteOffset": 60, "byteLength": 12}],
        "buffers": [{"byteLength": len(data)}]}
    document.update(changes)
    return document, data


def glb(document, data):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def npy(kind, shape, data, order="False"):
    header = f"{{'descr': '{kind}', 'fortran_order': {order}, 'shape': {shape}, }}"
    header = header.ljust(117) + "\n"
    return b"\x93NUMPY\x01\0" + struct.pack("<H", len(header)) + header.encode() + data


def main():
    head = 'wavelength = "532 nm"\n[slm]\ncolumns = 16\nrows = 16\npitch = "8 um"\n'
    at = 'position = "0 0 -10 mm"\n'
    objects = {
        "quad": 'type = "quad"\nwidth = "1 mm"\nheight = "1 mm"\nmaterial = "a"\n',
        "sphere": 'type = "sphere"\nsize = "1 mm"\nsegments = 8\nrotation = ["x 30 deg", "y 10 deg"]\n',
        "lathe": 'type = "lathe"\nprofile = { unit = "mm", points = [[0, 0], [1, 1]] }\n',
        "extrusion": 'type = "extrusion"\ndepth = "1 mm"\noutline = { unit = "mm", points = [[0, 0], [1, 0], [0, 1]] }\n',
        "points": 'type = "point_quad"\nwidth = "1 mm"\nheight = "1 mm"\ncolumns = 3\nrows = 3\n',
        "cube": 'type = "wireframe_cube"\nsize = "1 mm"\n',
        "shape": 'type = "shape"\nshape = "s"\n'}
    material = '[materials.a]\ntype = "conductor"\nmetal = "Au"\nroughness = 0.5\n[materials.b]\ntype = "dielectric"\nindex = 1.5\n'
    rest = ('[[shape.s]]\ntype = "box"\nsize = "1 1 1 mm"\n[[light]]\ntype = "point"\nposition = "0 0 0 mm"\nintensity = 1\n'
            '[trace]\npaths = 4\npath_expressions = ["E(D|G)L"]\n[camera]\ndistances = "30 mm"\n')
    for name, text in objects.items():
        seed("scene", name, head + material + "[[object]]\n" + text + at + rest)
    seed("scene", "extends", 'extends = "none.toml"\nwavelength = ["638 nm", "520 nm"]\n')

    panel = 'columns = 16\nrows = 16\npitch = "8 um"\nlevels = 256\nfill_factor = 0.9\nphase_range = "6.28 rad"\n'
    seed("panel", "plain", panel)
    seed("panel", "effects", panel + 'crosstalk = 0.5\ngap_amplitude = 0.1\ngap_phase = "10 deg"\nflicker = 0.01\n'
         'aberration = [{ n = 2, m = 0, rms = "0.3 rad" }]\ndead_pixels = [[1, 2, 3]]\ndead_fraction = 0.1\n')
    seed("panel", "crystal", panel + 'polariser = "none"\nanalyser = "-45 deg"\nplates_before = [{ axis = "22.5 deg", delay = "180 deg" }]\n'
         '[crystal]\nkind = "transmissive"\ndirector = "10 deg"\ntwist = "-90 deg"\nfirst_delay = "400 deg"\nlast_delay = "0 deg"\n')
    seed("panel", "preset", 'preset = "pluto"\ncolumns = 8\nmodulation = "phase"\n')
    seed("calibration", "radians", "level,phase_rad,amplitude\n0,0,1\n128,3.14,0.9\n255,6.28,1\n")
    seed("calibration", "pi", "# comment\ngrey, phase_pi\n0, 0\n255, 2\n")
    seed("calibration", "index", "# wavelength n k\n450 nm 0.04 2.6\n650 nm, 0.05, 3.4\n")

    header = "ply\nformat {} 1.0\ncomment name a\ncomment wavelength_m 5.32e-07\nelement vertex 3\nproperty double x\n" \
             "property double y\nproperty double z\nproperty float amplitude\nproperty float phase\n"
    faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [(0, 0, -.1, 1, 0), (1, 0, -.1, 1, 1), (0, 1, -.1, 1, 2)]
    text = "".join(" ".join(map(str, row)) + "\n" for row in rows) + "3 0 1 2\n"
    seed("ply", "ascii", header.format("ascii") + faces + text)
    for order, sign in (("little", "<"), ("big", ">")):
        body = b"".join(struct.pack(sign + "3d2f", *row) for row in rows) + struct.pack(sign + "B3i", 3, 0, 1, 2)
        seed("ply", order, header.format(f"binary_{order}_endian").encode() + faces.encode() + body)
    seed("ply", "strip", "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nelement tristrips 1\n"
         "property list int int vertex_indices\nend_header\n" + "0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n1 1 0 1 2 3\n" + "6 0 1 2 -1 1 2 \n")
    seed("ply", "soup", (DATA / "soup.ply").read_bytes())

    vertices = "v 0 0 0\nv 1 0 0 1 0.5 0\nv 1 1 0\nv 0 1 0 1\nvt 0 0\nvt 1 0 0\nvn 0 0 1\n"
    library = b"newmtl a\nKd 1 0.5 0\nKs 1 1 1\nNs 30\nillum 2\nd 0.5\nmap_Kd -s 1 1 1 -bm 0.5 x y.png\nbump b.png\nPr 0.5\nKe 1 1 1\n"
    seed("obj", "faces", (f"mtllib m.mtl\no one\n{vertices}usemtl a\nf 1/1/1 2/2/1 3//1\nf -4 -3 -2 -1\ng two\nl 1 2\nf 1 2 3 \\\n4\n").encode()
         + LINE + library)
    seed("obj", "concave", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n")
    seed("obj", "first", b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" + LINE + b"map_Kd x.png\nnewmtl a\n")

    document, data = gltf()
    seed("gltf", "glb", glb(document, data))
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    seed("gltf", "embedded", json.dumps(gltf(buffers=[{"byteLength": len(data), "uri": uri}])[0]))
    picture = png(2, 2, 3, 8, [bytes(6), bytes(6)])
    textured, data = gltf(
        textures=[{"source": 0, "sampler": 0}], samplers=[{"wrapS": 33071}], images=[{"bufferView": 3, "mimeType": "image/png"}],
        materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 0, "extensions": {
            "KHR_texture_transform": {"scale": [2, 1], "offset": [0.5, 0], "rotation": 1}}}}, "normalTexture": {"index": 0, "scale": 1},
            "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.3}}}])
    textured["bufferViews"].append({"buffer": 0, "byteOffset": len(data), "byteLength": len(picture)})
    textured["buffers"][0]["byteLength"] = len(data) + len(picture)
    seed("gltf", "textured", glb(textured, data + picture))
    keys = struct.pack("<2f", 0, 1) + struct.pack("<8f", 0, 0, 0, 1, 0, 1, 0, 0)
    animated, data = gltf(animations=[{"name": "turn", "samplers": [{"input": 3, "output": 4, "interpolation": "LINEAR"}], "channels": [
        {"sampler": 0, "target": {"node": 1, "path": "rotation"}},
        {"sampler": 0, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {
            "pointer": "/materials/0/pbrMetallicRoughness/baseColorFactor"}}}}]}])
    animated["accessors"] += [{"bufferView": 3, "componentType": 5126, "count": 2, "type": "SCALAR"},
                              {"bufferView": 3, "byteOffset": 8, "componentType": 5126, "count": 2, "type": "VEC4"}]
    animated["bufferViews"].append({"buffer": 0, "byteOffset": len(data), "byteLength": len(keys)})
    animated["buffers"][0]["byteLength"] = len(data) + len(keys)
    seed("gltf", "animated", glb(animated, data + keys))
    sparse, data = gltf()
    sparse["accessors"][0]["sparse"] = {"count": 1, "indices": {"bufferView": 2, "componentType": 5125}, "values": {"bufferView": 0}}
    seed("gltf", "sparse", glb(sparse, data))

    metadata = json.dumps({"pitch_m": 8e-6, "wavelengths_m": [532e-9], "z_m": 0, "image": "virtual", "name": "n", "frame": 1,
                           "filter": {"u0_per_m": 0, "v0_per_m": 0, "half_u_per_m": 1, "half_v_per_m": 1}}).encode()
    seed("npy", "single", npy("<c8", "(2, 2)", bytes(32)) + LINE + metadata)
    seed("npy", "double", npy("<c16", "(1, 2, 2)", bytes(64), "True") + LINE + metadata)

    hologram = json.dumps({
        "pitch_m": 8e-6, "wavelength_m": 532e-9, "levels": 256, "modulation": "phase", "image": "virtual", "encoder": "phase",
        "effects": ["calibration"], "slm": {"name": "a", "levels": 256, "fill_factor": 1, "design_wavelength_m": 0, "effects": {
            "calibration": {"phase_rad": [0, 1], "amplitude": [1, 1]}, "aberration": [{"n": 2, "m": 0, "rms_rad": 1}],
            "dead_pixels": [[0, 0, 0]]}}}).encode()
    seed("png", "grey", png(2, 2, 1, 8, [bytes(2), bytes([1, 2])]) + LINE + hologram)
    seed("png", "grey16", png(2, 2, 1, 16, [bytes(4), bytes(4)]) + LINE + b'{"pitch_m": 8e-6, "wavelength_m": 5e-7, "levels": 1024}')
    seed("png", "rgba", png(2, 2, 4, 8, [bytes(8), bytes(8)]))
    seed("exr", "rgb", exr([b"R", b"G", b"B"], 2, 2, 0))
    seed("exr", "field", exr([b"real", b"imag"], 2, 2, 0))
    seed("hdr", "flat", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1\n\n-Y 2 +X 2\n" + bytes([128, 128, 128, 129]) * 4)
    seed("hdr", "runs", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n" + bytes([2, 2, 0, 8]) + bytes([136, 128]) * 4)
    seed("picture", "bmp", b"BM" + struct.pack("<IHHI", 70, 0, 0, 54) + struct.pack("<IiiHHIIiiII", 40, 2, 2, 1, 24, 0, 16, 0, 0, 0, 0) + bytes(16))
    seed("picture", "tga", struct.pack("<BBBHHBHHHHBB", 0, 0, 2, 0, 0, 0, 0, 0, 2, 2, 24, 0) + bytes(12))
    seed("picture", "tga_runs", struct.pack("<BBBHHBHHHHBB", 0, 0, 10, 0, 0, 0, 0, 0, 2, 2, 24, 0) + bytes([131, 1, 2, 3]))
    seed("picture", "tiff", b"II*\0" + struct.pack("<I", 8) + struct.pack("<H", 9) + b"".join(
        struct.pack("<HHII", *entry) for entry in ((256, 3, 1, 2), (257, 3, 1, 2), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, 1),
                                                   (273, 4, 1, 122), (277, 3, 1, 1), (278, 3, 1, 2), (279, 4, 1, 4))) + bytes(8))
    # The first byte chooses the format: its remainder by 5.
    seed("assimp", "stl", "\x05solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n")
    triangle = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
    seed("assimp", "stl_binary", b"\x05" + bytes(80) + struct.pack("<I", 1) + triangle)
    seed("assimp", "off", "\x06OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    seed("assimp", "dae", '\x07<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">'
         '<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array>'
         '<technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>'
         '<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/>'
         '</vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>'
         '</library_geometries><library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene>'
         '</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>\n')

    def chunk3ds(kind, content):
        return struct.pack("<HI", kind, 6 + len(content)) + content

    mesh = chunk3ds(0x4100, chunk3ds(0x4110, struct.pack("<H9f", 3, 0, 0, 0, 1, 0, 0, 0, 1, 0))
                    + chunk3ds(0x4120, struct.pack("<H4H", 1, 0, 1, 2, 0)))
    seed("assimp", "3ds", b"\x08" + chunk3ds(0x4D4D, chunk3ds(0x3D3D, chunk3ds(0x4000, b"a\0" + mesh))))
    for i, text in enumerate(("E(D|G)L", "E.*L", "ES*(D|G)L", "ED+L?", "532 nm", "0 0 -300 mm", "1.5 deg", "2 GiB")):
        seed("path_expression", str(i), text)
    head = " HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nSec-Fetch-Site: same-origin\r\n\r\n"
    seed("request", "page", "GET /secret/" + head)
    seed("request", "view", "GET /secret/view?distance=300+mm&pupil=4%20mm&eye=0+0+250+mm&effects=gaps,flicker&items=0,2" + head)
    seed("request", "query", "subpixels=3&sampling=point&exposure=0.5&focal-length=17+mm&draft=1")
    seed("report", "object", '{"a": [1, 2.5e3, true, null, "\\u00e4"], "b": {"c": {}}}')


if __name__ == "__main__":
    main()
