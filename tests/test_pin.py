#!/usr/bin/env python3
"""scripts/pin: what it leaves out of a comparison, and how it describes files that differ: python3 test_pin.py."""

import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "scripts" / "pins"))

from bench import LOCKED_CACHE  # noqa: E402
from canonical import canonical  # noqa: E402
from differences import describe, read_exr, read_hdf5, read_png  # noqa: E402
from jobs import JOBS  # noqa: E402


def npy(values, kind="<f4", code="f"):
    head = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': ({len(values)},), }}".encode()
    head += b" " * (64 - (len(head) + 11) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + struct.pack(f"<{len(values)}{code}", *values)


def png(rows, text=None):
    """A grey PNG; rows: bytes with the number of their filter in front."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]) - 1, len(rows), 8, 0, 0, 0, 0)) +
            (chunk(b"tEXt", b"holotrace\0" + json.dumps(text).encode()) if text else b"") +
            chunk(b"IDAT", zlib.compress(b"".join(map(bytes, rows)))) + chunk(b"IEND", b""))


def exr(values, columns, rows, is_packed):
    """One channel of floats; packed as ZIP packs it: even bytes first, then differences."""
    def attribute(name, kind, value):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(value)) + value

    head = b"v/1\x01\x02\0\0\0" + attribute(b"channels", b"chlist", b"Y\0" + struct.pack("<iiii", 2, 0, 1, 1) + b"\0")
    head += attribute(b"compression", b"compression", b"\x03" if is_packed else b"\0")
    head += attribute(b"dataWindow", b"box2i", struct.pack("<4i", 0, 0, columns - 1, rows - 1)) + b"\0"
    data = struct.pack(f"<{len(values)}f", *values)
    if not is_packed:
        lines = [data[j * 4 * columns:(j + 1) * 4 * columns] for j in range(rows)]
        blocks = [(j, line) for j, line in enumerate(lines)]
    else:
        mixed = data[0::2] + data[1::2]
        steps = bytes([mixed[0]] + [(b - a + 128) & 255 for a, b in zip(mixed, mixed[1:])])
        blocks = [(0, zlib.compress(steps))]
    at, offsets, body = len(head) + 8 * len(blocks), b"", b""
    for row, block in blocks:
        offsets += struct.pack("<Q", at + len(body))
        body += struct.pack("<iI", row, len(block)) + block
    return head + offsets + body


class Canonical(unittest.TestCase):
    def test_a_locked_cache_is_known_by_the_programs_words(self):
        source = (ROOT / "src" / "holotrace" / "io" / "files" / "folders.cpp").read_text()
        self.assertIn(LOCKED_CACHE, source.replace('"\n', "").replace('      "', ""))

    def same(self, name, a, b, **more):
        self.assertEqual(canonical(name, a.encode(), **more), canonical(name, b.encode(), **more))

    def differ(self, name, a, b):
        self.assertNotEqual(canonical(name, a.encode()), canonical(name, b.encode()))

    def test_has_no_times(self):
        self.same("report.json", '{"seconds": 0.25, "rays": 3}', '{"seconds": 1e-05, "rays": 3}')
        self.same("report.json", '"look at 30 mm predicted_seconds": 2.5,', '"look at 30 mm predicted_seconds": 2,')
        self.same("report.json", '"synthesize ratio": 0.9', '"synthesize ratio": 1.1')
        self.same("messages.txt", "trace      0.16 s  426 waves\n", "trace     10.16 s  426 waves\n")
        self.same("messages.txt", "seconds            0.3\n", "seconds            12.5\n")
        self.same("messages.txt", '"stages": {\n "trace": 0.1 },', '"stages": {\n "trace": 0.3 },')
        self.same("f.h5.partial.json", '{"bands":16,"finished":[[0,1]]}', '{"bands":16,"finished":[[0,3],[5,5]]}')

    def test_has_no_versions_and_paths(self):
        self.same("report.json", '"holotrace": "0.1.0"', '"holotrace": "0.2.0"')
        self.same("messages.txt", "holotrace 0.1.0\n", "holotrace 0.2.0\n")
        places = (("/a/build/pins", "PINS"), ("/b", "PINS"))
        self.same("messages.txt", "read /a/build/pins/x.npy", "read /b/x.npy", places=places)

    def test_keeps_all_else(self):
        self.differ("report.json", '"rays": 3', '"rays": 4')
        self.differ("report.json", '{"seconds": 1, "rays": 3}', '{"seconds": 1,"rays": 3}')  # the layout is a part of the file
        self.differ("report.json", '"psnr_db": 20.5', '"psnr_db": 20.6')
        self.differ("report.json", '"stages": [{"waves": 3}]', '"stages": [{"waves": 4}]')
        self.differ("messages.txt", "at 296.7 mm: 20 samples", "at 296.8 mm: 20 samples")
        self.differ("messages.txt", "3 states", "4 states")
        self.assertEqual(canonical("view.png", b'"seconds": 1'), b'"seconds": 1')


class Differences(unittest.TestCase):
    def test_of_arrays_are_measured(self):
        # (0, 3, 4) and (0, 3, 4.5): 0.5 of a norm of 5.
        found, = describe("f.npy", npy([0, 3, 4]), npy([0, 3, 4.5]))
        self.assertEqual(found, "values: relative L2 0.1, largest difference 0.5 (1 of 3 numbers)")
        found, = describe("f.npy", npy([3, 4], "<c8"), npy([3, -4], "<c8"))
        self.assertIn("relative L2 1.6, largest difference 8", found)
        self.assertIn("not finite", *describe("f.npy", npy([1, 2]), npy([1, float("nan")])))
        self.assertEqual(len(describe("f.npy", npy([1, 2]), npy([1, 2, 3]))), 2)  # the header and the numbers

    def test_of_pictures_are_those_of_pixels_and_of_metadata(self):
        # Rows 10 20 30 and 11 22 33, written with each of the filters none, sub, up, mean and Paeth.
        plain = png([[0, 10, 20, 30], [0, 11, 22, 33]])
        for row in ([1, 11, 11, 11], [2, 1, 2, 3], [3, 6, 7, 7], [4, 1, 2, 3]):
            self.assertEqual(read_png(png([[0, 10, 20, 30], row]))["values"], read_png(plain)["values"])
        found, = describe("h.png", plain, png([[0, 10, 20, 30], [0, 11, 22, 40]]))
        self.assertIn("largest difference 7 (1 of 6 numbers)", found)
        found, = describe("h.png", png([[0, 1]], {"slm": {"levels": 4}}), png([[0, 1]], {"slm": {"levels": 5}}))
        self.assertEqual(found, 'text "holotrace": slm.levels: 4 became 5')

    def test_of_exr_are_those_of_channels(self):
        values = [0.5, 1.25, -3, 7, 8, 0] * 8  # a block that does not shrink is not packed
        for is_packed in (False, True):
            self.assertEqual(list(read_exr(exr(values, 8, 6, is_packed))["channel Y"]), values)
        found, = describe("v.exr", exr([3, 4], 2, 1, False), exr([3, 5], 2, 1, False))
        self.assertIn("channel Y: relative L2 0.2", found)

    def test_of_hdf5_are_those_of_datasets(self):
        data = (ROOT / "fuzz" / "seeds" / "hdf5" / "field").read_bytes()
        parts = read_hdf5(data)
        name, values = next(iter(parts.items()))
        self.assertEqual((name, len(values)), ("dataset 1 of the shape (4, 4)", 32))
        self.assertIn("attribute pitch_m of dataset 1", parts)
        at = data.index(struct.pack("<d", next(filter(None, values))), len(data) // 2)  # of complex128, behind the attributes
        found, = describe("f.h5", data, data[:at] + struct.pack("<d", 0.25) + data[at + 8:])
        self.assertRegex(found, r"shape \(4, 4\): relative L2 .* \(1 of 32 numbers\)")
        pitch = data.replace(struct.pack("<d", 8e-6), struct.pack("<d", 9e-6))
        self.assertIn("attribute pitch_m of dataset 1", *describe("f.h5", data, pitch))
        self.assertRegex(*describe("f.h5", data, data[:9] + b"?" + data[10:]), "1 byte.* the first at 9, none of them in a value")

    def test_of_points_are_those_of_columns(self):
        def ply(x):
            head = "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty double x\nproperty float phase\nend_header\n"
            return head.encode() + struct.pack("<dfdf", 1, 2, x, 4)

        self.assertEqual(describe("s.ply", ply(3), ply(3.5)),
                         ["x: relative L2 0.16, largest difference 0.5 (1 of 2 numbers)"])

    def test_of_json_are_the_first_member(self):
        def found(a, b):
            return describe("r.json", json.dumps(a).encode(), json.dumps(b).encode())[0]
        self.assertEqual(found({"a": [1, {"b": 2}]}, {"a": [1, {"b": 3}]}), "a[1].b: 2 became 3")
        self.assertEqual(found({"a": 1}, {}), "a is missing")
        self.assertEqual(found({"a": 1}, {"a": 1, "c": 0}), "c is new")
        self.assertEqual(found({"a": [1]}, {"a": [1, 2]}), "a: 1 members became 2")
        self.assertIn("another order", found({"a": 1, "b": 2}, {"b": 2, "a": 1}))
        self.assertEqual(found({"a": 1}, {"a": 1.0}), "a: 1 became 1.0")

    def test_of_texts_are_the_first_line_and_of_others_bytes(self):
        self.assertEqual(describe("m.txt", b"one\ntwo\n", b"one\nzwei\n"), ['line 2: "two" became "zwei"'])
        self.assertEqual(describe("a.gif", b"abc", b"axcd"), ["1 byte(s) differ, the first at 1; 3 bytes became 4"])
        self.assertIn("not read", *describe("a.npy", b"abc", b"abd"))


# A program that has no devices, and whose help is in a file beside it.
PROGRAM = """#!/bin/sh
case $1 in
  --version) echo "holotrace 0.1.0" ;;
  --help) cat "$(dirname "$0")/help" ;;
  *) exit 1 ;;
esac
"""


class Script(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.program = self.folder / "holotrace"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)
        self.say("It takes 3 s.")

    def say(self, text):
        (self.folder / "help").write_text(text + "\n")

    def pin(self, *words):
        command = [sys.executable, ROOT / "scripts" / "pin", *words, "--program", self.program, "--only", "help"]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def test_names_the_files_that_differ(self):
        record = str(self.folder / "record")
        self.assertIn("expected a record", self.pin("compare", record).stderr)
        made = self.pin("record", record)
        self.assertEqual((made.returncode, made.stderr), (0, ""))
        self.say("It takes 4 s.")
        self.assertIn("no file differs, of 1 files in 1 jobs", self.pin("compare", record).stdout)
        self.say("It took 4 s.")
        compared = self.pin("compare", record)
        self.assertEqual(compared.returncode, 1)
        self.assertIn('help\n  messages.txt: line 2: "It takes 0 s." became "It took 0 s."\n', compared.stdout)

    def test_refuses_the_record_of_another_machine(self):
        record = self.folder / "record"
        self.pin("record", str(record))
        facts = json.loads((record / "record.json").read_text())
        (record / "record.json").write_text(json.dumps({**facts, "processor": "another one"}))
        refused = self.pin("compare", str(record))
        self.assertEqual(refused.returncode, 1)
        self.assertIn("expected the machine of the record", refused.stderr)
        self.assertEqual(self.pin("compare", str(record), "--any-machine").returncode, 0)

    def test_says_which_job_fails(self):
        record = str(self.folder / "record")
        self.pin("record", record)
        os.remove(self.folder / "help")
        compared = self.pin("compare", record)
        self.assertEqual(compared.returncode, 1)
        self.assertIn("help: exit code 1 of --help", compared.stdout)

    def test_has_one_job_of_a_name_and_reads_from_earlier_ones(self):
        earlier = set()
        for job in JOBS:
            self.assertNotIn(job.name, earlier)
            self.assertLessEqual(set(job.sources), earlier)
            earlier.add(job.name)

    def test_wants_the_name_of_a_job(self):
        wrong = subprocess.run([sys.executable, ROOT / "scripts" / "pin", "--list", "--only", "nothing"], capture_output=True,
                               text=True, check=False)
        self.assertEqual(wrong.returncode, 1)
        self.assertIn("expected the name of a job, got nothing", wrong.stderr)


if __name__ == "__main__":
    unittest.main()
