"""How two files differ: the readers share no code with the program, and need nothing but Python."""
import array
import json
import math
import re
import struct
import sys
import zlib


def numbers(code, data, is_big=False):
    """Numbers of one kind (a letter of `struct`) in bytes, as an array."""
    values = array.array(code)
    values.frombytes(data[:len(data) - len(data) % values.itemsize])
    if is_big != (sys.byteorder == "big"):
        values.byteswap()
    return values


# Each reader returns the parts of a file by name: an array of numbers, a list or dict of JSON, or a text.

def read_npy(data):
    size = struct.unpack_from("<H", data, 8)[0]
    head = data[10:10 + size].decode("latin-1").strip()
    kind = re.search(r"'descr': '[<|](\w+)'", head).group(1)
    code = {"c8": "f", "c16": "d", "f4": "f", "f8": "d", "u1": "B", "u2": "H", "i4": "i", "u4": "I", "b1": "B"}[kind]
    return {"header": head, "values": numbers(code, data[10 + size:])}


def paeth(left, above, corner):
    guess = left + above - corner
    distances = abs(guess - left), abs(guess - above), abs(guess - corner)
    return (left, above, corner)[distances.index(min(distances))]


def unfiltered(rows, stride, step):
    """Pixels of PNG rows, each behind the number of its filter."""
    before = bytearray(stride)
    out = bytearray()
    for start in range(0, len(rows), stride + 1):
        kind, row = rows[start], bytearray(rows[start + 1:start + 1 + stride])
        for i in range(stride if kind else 0):
            left = row[i - step] if i >= step else 0
            corner = before[i - step] if i >= step else 0
            row[i] = (row[i] + (left, before[i], (left + before[i]) // 2, paeth(left, before[i], corner))[kind - 1]) & 255
        out += row
        before = row
    return bytes(out)


def read_png(data):
    parts, packed, at = {}, b"", 8
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + size]
        at += 12 + size
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack_from(">IIBB", body)
            parts["header"] = f"{width} x {height}, {depth} bits, colours {colour}"
        elif kind == b"IDAT":
            packed += body
        elif kind in (b"tEXt", b"iTXt"):
            key, _, text = body.partition(b"\0")
            text = text.decode("utf-8", errors="replace")
            parts[f'text "{key.decode()}"'] = json.loads(text) if text.startswith("{") else text
        elif kind != b"IEND":
            parts[kind.decode()] = body.hex()
    samples = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[colour]
    step = max(1, samples * depth // 8)
    pixels = unfiltered(zlib.decompress(packed), (width * samples * depth + 7) // 8, step)
    return {**parts, "values": numbers("H" if depth == 16 else "B", pixels, is_big=True)}


def unpacked(block):
    """The bytes of a block of EXR's ZIP compression: differences of bytes, even ones first."""
    data = bytearray(zlib.decompress(block))
    for i in range(1, len(data)):
        data[i] = (data[i - 1] + data[i] - 128) & 255
    half = (len(data) + 1) // 2
    out = bytearray(len(data))
    out[0::2], out[1::2] = data[:half], data[half:]
    return bytes(out)


def read_exr(data):
    """Scan lines of floats, not compressed or by ZIP, as the program writes them."""
    parts, at = {}, 8
    while data[at]:
        name, kind = data[at:at + 512].split(b"\0")[:2]
        at += len(name) + len(kind) + 2
        size = struct.unpack_from("<I", data, at)[0]
        parts[name.decode()], at = data[at + 4:at + 4 + size], at + 4 + size
    names = [entry.decode() for entry in re.findall(rb"([^\0]+)\0.{16}", parts["channels"], re.S)]
    left, top, right, bottom = struct.unpack("<4i", parts["dataWindow"])
    columns, rows = right - left + 1, bottom - top + 1
    lines = {0: 1, 2: 1, 3: 16}[parts["compression"][0]]
    channels = {name: bytearray() for name in names}
    for offset in struct.unpack_from(f"<{-(-rows // lines)}Q", data, at + 1):
        row, size = struct.unpack_from("<iI", data, offset)
        block, count = data[offset + 8:offset + 8 + size], min(lines, bottom + 1 - row)
        if size < count * columns * 4 * len(names):
            block = unpacked(block)
        for line in range(count):
            for i, name in enumerate(names):
                start = (line * len(names) + i) * columns * 4
                channels[name] += block[start:start + columns * 4]
    return {**{name: value.hex() for name, value in parts.items()},
            **{f"channel {name}": numbers("f", values) for name, values in channels.items()}}


def chunks_of(data, at, rank):
    """(offsets, size, address) of the chunks below a node of HDF5's B-tree."""
    level, count = struct.unpack_from("<BH", data, at + 5)
    key = 8 + 8 * (rank + 1)
    for i in range(count):
        start = at + 24 + i * (key + 8)
        size, _, *offsets = struct.unpack_from(f"<II{rank + 1}Q", data, start)
        child = struct.unpack_from("<Q", data, start + key)[0]
        if level:
            yield from chunks_of(data, child, rank)
        else:
            yield offsets[:rank], size, child


def messages_of(data, at):
    """(kind, bytes) of the messages of the object whose header is at this place."""
    flags = data[at + 5]
    start = at + 6 + (16 if flags & 32 else 0) + (4 if flags & 16 else 0)
    size = 1 << (flags & 3)
    blocks = [(start + size, int.from_bytes(data[start:start + size], "little"))]
    for start, size in blocks:  # a message may add a block
        end = start + size
        while start + 4 <= end:
            kind, length, _ = struct.unpack_from("<BHB", data, start)
            start += 6 if flags & 4 else 4
            body, start = data[start:start + length], start + length
            if kind == 0x10:
                place, size = struct.unpack("<QQ", body)
                blocks.append((place + 4, size - 8))  # without its signature and its checksum
            else:
                yield kind, body


def read_hdf5(data):
    """Datasets of floats, whole or in chunks of whole rows, and their attributes, as the program writes them."""
    parts, count = {}, 0
    for found in re.finditer(rb"OHDR\x02", data):
        shape, code, values, attributes = None, "f", None, {}
        for kind, body in messages_of(data, found.start()):
            if kind == 1:
                shape = struct.unpack_from(f"<{body[1]}Q", body, 4)
            elif kind == 3:
                code = "f" if b"\x11\x20\x1f\0\x04\0\0\0" in body else "d"
            elif kind == 8 and body[:2] == b"\x03\x01":
                start, size = struct.unpack_from("<QQ", body, 2)
                values = data[start:start + size]
            elif kind == 8 and body[:2] == b"\x03\x02":
                chunks = chunks_of(data, struct.unpack_from("<Q", body, 3)[0], body[2] - 1)
                values = b"".join(data[start:start + size] for _, size, start in sorted(chunks))
            elif kind == 12:
                size = struct.unpack_from("<H", body, 2)[0]
                attributes[body[9:8 + size].decode(errors="replace")] = body[9 + size:].hex()
        if values is not None:
            count += 1
            parts[f"dataset {count} of the shape {shape}"] = numbers(code, values)
            parts |= {f"attribute {name} of dataset {count}": value for name, value in attributes.items()}
    return parts


def read_ply(data):
    """Columns of a binary file of vertices; of an ASCII file the lines."""
    head, _, body = data.partition(b"end_header\n")
    lines = head.decode().splitlines()
    if "format binary_little_endian 1.0" not in lines:
        return {"text": data.decode(errors="replace")}
    codes = {"double": "d", "float": "f", "uint": "I", "int": "i", "uchar": "B", "ushort": "H"}
    columns = [line.split()[1:] for line in lines if line.startswith("property ")]
    row = struct.Struct("<" + "".join(codes[kind] for kind, _ in columns))
    rows = list(row.iter_unpack(body[:len(body) - len(body) % row.size]))
    return {"header": "\n".join(lines),
            **{name: [values[i] for values in rows] for i, (_, name) in enumerate(columns)}}


def read_json(data):
    return {"": json.loads(data)}


def read_text(data):
    return {"": data.decode(errors="replace")}


READERS = {".npy": read_npy, ".png": read_png, ".exr": read_exr, ".h5": read_hdf5, ".ply": read_ply, ".json": read_json,
           ".txt": read_text, ".svg": read_text, ".toml": read_text, ".csv": read_text}


def of_numbers(old, new):
    if len(old) != len(new):
        return f"{len(old)} numbers became {len(new)}"
    pairs = [(float(a), float(b)) for a, b in zip(old, new) if a != b and not (a != a and b != b)]
    if not pairs:
        return ""
    if not all(map(math.isfinite, [value for pair in pairs for value in pair])):
        return f"{len(pairs)} of {len(old)} numbers differ, some of them are not finite"
    norm, error = math.hypot(*filter(math.isfinite, old)), math.hypot(*(b - a for a, b in pairs))
    relative = f"{error / norm:.2g}" if norm else "infinite, from 0"
    largest = max(abs(b - a) for a, b in pairs)
    return f"relative L2 {relative}, largest difference {largest:.3g} ({len(pairs)} of {len(old)} numbers)"


def short(value):
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else text[:57] + "…"


def of_json(old, new, path=""):
    """The first member that differs."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in [*old, *(key for key in new if key not in old)]:
            here = f"{path}.{key}".lstrip(".")
            if key not in new or key not in old:
                return f"{here} {'is new' if key in new else 'is missing'}"
            if found := of_json(old[key], new[key], here):
                return found
        return "" if list(old) == list(new) else f"{path or 'members'}: in another order"
    if isinstance(old, list) and isinstance(new, list):
        for i, (a, b) in enumerate(zip(old, new)):
            if found := of_json(a, b, f"{path}[{i}]"):
                return found
        return "" if len(old) == len(new) else f"{path}: {len(old)} members became {len(new)}"
    same = old == new and type(old) is type(new)
    return "" if same else f"{path or 'value'}: {short(old)} became {short(new)}"


def of_text(old, new):
    old, new = old.splitlines(), new.splitlines()
    for i, (a, b) in enumerate(zip(old, new), 1):
        if a != b:
            start = max(0, next((k for k, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b))) - 20)
            return f"line {i}: {short(a[start:])} became {short(b[start:])}"
    return "" if len(old) == len(new) else f"{len(old)} lines became {len(new)}"


def of_bytes(old, new):
    changed = [i for i, (a, b) in enumerate(zip(old, new)) if a != b]
    where = f", the first at {changed[0]}" if changed else ""
    size = f"; {len(old)} bytes became {len(new)}" if len(old) != len(new) else ""
    return f"{len(changed)} byte(s) differ{where}{size}"


def describe(name, old, new):
    """
    One sentence for each part of a file that differs, with the size of the difference.

    name      of the file; its ending tells the kind
    old, new  bytes, in their canonical form
    """
    reader = next((reader for ending, reader in READERS.items() if name.endswith(ending)), None)
    try:
        before, after = (reader(data) for data in (old, new)) if reader else ({}, {})
    except (ValueError, KeyError, IndexError, AttributeError, struct.error, zlib.error) as error:
        return [f"{of_bytes(old, new)} (not read: {type(error).__name__} {error})"]
    sentences = []
    for part in [*before, *(part for part in after if part not in before)]:
        if part not in after or part not in before:
            sentences.append(f"{part} {'is new' if part in after else 'is missing'}")
            continue
        a, b = before[part], after[part]
        if isinstance(a, array.array) or isinstance(a, list) and not name.endswith(".json"):
            found = of_numbers(a, b)
        elif isinstance(a, str) and isinstance(b, str):
            found = of_text(a, b)
        else:
            found = of_json(a, b)
        if found:
            sentences.append(f"{part}: {found}".removeprefix(": "))
    return sentences or [of_bytes(old, new) + (", none of them in a value" if reader else "")]
