#!/usr/bin/env python3
"""`holotrace display` on a virtual monitor (Xvfb), whose memory is read back: python3 display_test.py PROGRAM.

Without Xvfb or the program's display module: exit code 77.
"""

import os
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.parse
import urllib.request
import zlib

PROGRAM = os.path.abspath(sys.argv.pop(1))
if not shutil.which("Xvfb") or not os.path.exists(os.path.join(os.path.dirname(PROGRAM), "holotrace_display.so")):
    print("skipped: no Xvfb, or a build without SDL 2; scripts/setup --tests installs both")
    sys.exit(77)

COLUMNS, ROWS = 320, 180


def png(path, greys, columns=COLUMNS, rows=ROWS, bits=8, has_metadata=True, wavelength=532e-9):
    """A grey PNG with the metadata of a hologram, without any code of the program. `greys` are its big-endian bytes."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    row = columns * bits // 8
    lines = b"".join(b"\0" + greys[j * row:(j + 1) * row] for j in range(rows))
    text = b"holotrace\0" + b'{"kind": "hologram", "pitch_m": 8e-06, "wavelength_m": %g, "levels": 256, ' \
                            b'"modulation": "phase", "image": "virtual", "encoder": "phase"}' % wavelength
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, bits, 0, 0, 0, 0)) +
                   (chunk(b"tEXt", text) if has_metadata else b"") + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


class Display(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="holotrace_display_")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        ready, told = os.pipe()
        cls.monitor = subprocess.Popen(["Xvfb", "-displayfd", str(told), "-screen", "0", f"{COLUMNS}x{ROWS}x24",
                                        "-fbdir", cls.folder, "-nolisten", "tcp"], pass_fds=[told],
                                       stderr=subprocess.DEVNULL)
        os.close(told)
        cls.addClassCleanup(cls.monitor.wait)
        cls.addClassCleanup(cls.monitor.terminate)
        with os.fdopen(ready) as file:
            number = file.readline().strip()
        cls.environment = {**os.environ, "DISPLAY": f":{number}", "SDL_VIDEODRIVER": "x11"}
        # All greys, in patterns that any scaling, smoothing, turn or gamma changes.
        cls.greys = [bytes((i * step + i // COLUMNS * 7) % 256 for i in range(COLUMNS * ROWS)) for step in (1, 3, 85)]
        cls.paths = [os.path.join(cls.folder, f"hologram_{i}.png") for i in range(3)]
        for path, greys in zip(cls.paths, cls.greys):
            png(path, greys)

    def channels(self):
        """Red, green and blue of the monitor, from Xvfb's frame buffer (an XWD file)."""
        with open(os.path.join(self.folder, "Xvfb_screen0"), "rb") as file:
            data = file.read()
        header = struct.unpack(">25I", data[:100])
        begin = header[0] + 12 * header[19]  # after the header and the colours
        stride = header[12]
        pixels = b"".join(data[begin + j * stride:begin + j * stride + 4 * COLUMNS] for j in range(ROWS))
        return pixels[2::4], pixels[1::4], pixels[0::4]

    def screen(self):
        """The greys on the monitor; None where a pixel is not grey."""
        red, green, blue = self.channels()
        return blue if blue == green == red else None

    def run_display(self, *arguments):
        return subprocess.run([PROGRAM, "display", *arguments], env=self.environment, capture_output=True, text=True,
                              timeout=30)

    def test_shows_the_bytes_of_the_file(self):
        for path, greys in zip(self.paths, self.greys):
            job = subprocess.Popen([PROGRAM, "display", path], env=self.environment, stdout=subprocess.PIPE, text=True)
            end = time.time() + 15
            while self.screen() != greys and time.time() < end:
                time.sleep(0.05)
            self.assertEqual(self.screen(), greys)
            job.send_signal(signal.SIGINT)
            self.assertEqual(job.communicate(timeout=20)[0], "")
            self.assertEqual(job.returncode, 0)

    def test_shows_holograms_in_turn(self):
        job = subprocess.Popen([PROGRAM, "display", *self.paths, "--rate", "2"], env=self.environment,
                               stdout=subprocess.PIPE, text=True)
        seen = []
        end = time.time() + 20
        while len(seen) < 7 and time.time() < end:
            screen = self.screen()
            if screen in self.greys and (not seen or seen[-1] != self.greys.index(screen)):
                seen.append(self.greys.index(screen))
            time.sleep(0.01)
        job.send_signal(signal.SIGINT)
        self.assertIn("holograms shown at", job.communicate(timeout=20)[0])
        self.assertEqual(len(seen), 7)
        for before, after in zip(seen, seen[1:]):
            self.assertEqual(after, (before + 1) % 3, seen)

    def test_shows_levels_of_other_programs(self):
        """16 levels in 16 bits without metadata: level l is the grey 4096 l of the file, and 16 l on the monitor."""
        path = os.path.join(self.folder, "other.png")
        levels = [greys % 16 for greys in self.greys[1]]
        png(path, struct.pack(f">{len(levels)}H", *(4096 * level for level in levels)), bits=16, has_metadata=False)
        run = self.run_display(path, "--seconds", "1")
        self.assertIn("at most 256 levels", run.stderr)
        job = subprocess.Popen([PROGRAM, "display", path, "--levels", "16"], env=self.environment,
                               stdout=subprocess.PIPE, text=True)
        expected, end = bytes(16 * level for level in levels), time.time() + 15
        while self.screen() != expected and time.time() < end:
            time.sleep(0.05)
        self.assertEqual(self.screen(), expected)
        job.send_signal(signal.SIGINT)
        job.communicate(timeout=20)

    def shown(self, *arguments, until):
        """Red, green and blue on the monitor, at the latest after 15 seconds."""
        job = subprocess.Popen([PROGRAM, "display", *arguments], env=self.environment, stdout=subprocess.PIPE, text=True)
        end = time.time() + 15
        while self.channels() != until and time.time() < end:
            time.sleep(0.05)
        channels = self.channels()
        job.send_signal(signal.SIGINT)
        job.communicate(timeout=20)
        return channels

    def test_shows_what_it_writes(self):
        """Mirrored, with a blaze of four pixels: 64 of 256 greys more from pixel to pixel, from x = -(nx - 1)/2 on."""
        flags = ["--flip", "x", "--blaze", "32 um", "--pitch", "8 um"]
        out = os.path.join(self.folder, "out.bmp")
        run = self.run_display(self.paths[0], *flags, "-o", out)
        self.assertEqual(run.returncode, 0, run.stderr)
        with open(out, "rb") as file:
            data = file.read()
        rows = [data[1078 + j * COLUMNS:][:COLUMNS] for j in range(ROWS)]  # COLUMNS is a multiple of 4
        written = b"".join(reversed(rows))
        expected = bytearray()
        for j in range(ROWS):
            row = self.greys[0][j * COLUMNS:(j + 1) * COLUMNS]
            expected += bytes(round(grey + 64 * (i - (COLUMNS - 1) / 2)) % 256 for i, grey in enumerate(row))[::-1]
        self.assertEqual(written, bytes(expected))
        self.assertEqual(self.shown(self.paths[0], *flags, until=(written,) * 3), (written,) * 3)

    def test_shows_colours_together(self):
        for path, greys, wavelength in zip(self.paths, self.greys, (450e-9, 638e-9, 520e-9)):
            png(path + ".colour.png", greys, wavelength=wavelength)
        blue, red, green = self.greys
        paths = [path + ".colour.png" for path in self.paths]
        self.assertEqual(self.shown(*paths, "--pack", "colours", until=(red, green, blue)), (red, green, blue))

    def test_shows_a_live_scene(self):
        """The levels of the page's hologram, and others as soon as the page has changed the scene."""
        scene = os.path.join(self.folder, "scene.toml")
        with open(scene, "w") as file:
            file.write(f'wavelength = "532 nm"\n[slm]\ncolumns = {COLUMNS}\nrows = {ROWS}\npitch = "8 um"\n'
                       '[[light]]\ntype = "point"\nposition = "0 0 0 mm"\nintensity = 1\n'
                       '[[object]]\ntype = "quad"\nwidth = "0.5 mm"\nheight = "0.5 mm"\nposition = "0 0 -60 mm"\n')
        job = subprocess.Popen([PROGRAM, "view", scene, "--live", "--no-browser", "--monitor", "1"], env=self.environment,
                               stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(job.stdout.close)
        url = job.stdout.readline().strip()
        seen = []
        for place in ("0 0 -60 mm", "0.3 0 -70 mm"):
            values = urllib.parse.urlencode({"set.object.1.position": place})
            urllib.request.urlopen(f"{url}view?{values}").read()
            answer = urllib.request.urlopen(f"{url}panel?item=0&as=level&{values}").read()
            levels = answer[4 + struct.unpack("<I", answer[:4])[0]:]
            self.assertEqual(len(levels), COLUMNS * ROWS)
            end = time.time() + 15
            while self.screen() != levels and time.time() < end:
                time.sleep(0.05)
            self.assertEqual(self.screen(), levels)
            seen.append(levels)
        self.assertNotEqual(seen[0], seen[1])
        job.send_signal(signal.SIGINT)
        self.assertEqual(job.wait(timeout=20), 0)

    def test_counts_what_it_shows(self):
        run = self.run_display(*self.paths, "--seconds", "1")
        self.assertEqual(run.returncode, 0, run.stderr)
        words = run.stdout.split()
        self.assertEqual(words[1:4], ["holograms", "shown", "at"])
        rate = float(words[4])
        # A virtual monitor has no vertical sync, and "one second" is the program's own clock. Without waiting it would show
        # hundreds of times as many.
        self.assertLessEqual(int(words[0]), 2 * rate)
        self.assertGreater(int(words[0]), 1)

    def test_counts_changes_only(self):
        run = self.run_display(self.paths[0], "--seconds", "0.5")
        self.assertEqual((run.returncode, run.stdout), (0, ""), run.stderr)  # one hologram never changes

    def test_needs_a_desktop(self):
        for environment in ({"DISPLAY": "", "SDL_VIDEODRIVER": "offscreen"}, {"DISPLAY": ":4095", "SDL_VIDEODRIVER": ""},
                            {"DISPLAY": "", "SDL_VIDEODRIVER": "dummy"}):
            run = subprocess.run([PROGRAM, "display", self.paths[0], "--seconds", "1"], capture_output=True, text=True,
                                 env={name: value for name, value in {**os.environ, **environment}.items() if value},
                                 timeout=30)
            self.assertEqual(run.returncode, 1, environment)
            self.assertIn("expected a desktop with a monitor", run.stderr, environment)

    def test_refuses_what_does_not_fit(self):
        small = os.path.join(self.folder, "small.png")
        png(small, self.greys[0][:64 * 48], 64, 48)
        for arguments, expected in (
                ([small], f"expected a mode of monitor 1 with the panel's 64 x 48 pixels, got only {COLUMNS} x {ROWS}"),
                ([self.paths[0], small], "expected holograms of one panel"),
                ([self.paths[0], "--monitor", "9"], "expected a monitor from 1 to 1, got 9"),
                ([self.paths[0], "--rate", "1000"], "and a multiple of 1000 Hz")):
            run = self.run_display(*arguments, "--seconds", "1")
            self.assertEqual(run.returncode, 1, run.stdout)
            self.assertIn(expected, run.stderr)

    def test_needs_a_desktop(self):
        environment = {k: v for k, v in self.environment.items()
                       if k not in ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER")}
        run = subprocess.run([PROGRAM, "display", self.paths[0]], env=environment, capture_output=True, text=True,
                             timeout=30)
        self.assertEqual(run.returncode, 1)
        self.assertIn("expected a desktop with a monitor", run.stderr)


if __name__ == "__main__":
    unittest.main(argv=["display_test.py", *sys.argv[1:]], verbosity=2)
