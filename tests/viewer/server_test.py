#!/usr/bin/env python3
"""The server of `holotrace view` as an attacker and a careless client meet it: python3 server_test.py PROGRAM."""

import json
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import urllib.request
import zlib

PROGRAM = os.path.abspath(sys.argv.pop(1))

# A sanitizer keeps freed memory for a while, 256 MiB by default, to find its use.
KEPT_BY_SANITIZER = 300 if os.environ.get("HOLOTRACE_IS_SANITIZED") else 0  # [MiB]


class Server:
    def __init__(self, *arguments, stdin=None):
        self.process = subprocess.Popen([PROGRAM, "view", "--no-browser", *arguments], stdin=stdin,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().strip()
        self.port, self.token = re.fullmatch(r"http://[^/]*:(\d+)/([0-9a-f]{64})/", self.url).groups()
        self.port = int(self.port)

    def ask(self, path="", host=None, token=None, more="", method="GET"):
        host = host or f"127.0.0.1:{self.port}"
        token = self.token if token is None else token
        return self.send(f"{method} /{token}/{path} HTTP/1.1\r\nHost: {host}\r\n{more}\r\n".encode("latin-1"))

    def send(self, data):
        """The status of the answer; 0 if there is none."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=20) as connection:
            try:
                connection.sendall(data)
            except OSError:  # it has heard enough
                pass
            answer = b""
            try:
                while len(answer) < 64:
                    got = connection.recv(4096)
                    if not got:
                        break
                    answer += got
            except OSError:
                pass
            return int(answer.split()[1]) if answer.startswith(b"HTTP/1.1 ") else 0

    def memory(self):
        """Resident memory [MiB]."""
        with open(f"/proc/{self.process.pid}/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20

    def stop(self):
        self.process.send_signal(signal.SIGINT)
        self.process.communicate(timeout=20)
        return self.process.returncode


def field_in(folder, side):
    """A field of side × side samples of plane light, written without any code of the program."""
    path = os.path.join(folder, "field.npy")
    head = f"{{'descr': '<c8', 'fortran_order': False, 'shape': ({side}, {side}), }}".encode()
    head += b" " * (64 - (len(head) + 11) % 64) + b"\n"
    with open(path, "wb") as file:
        file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + struct.pack("<2f", 1, 0) * side**2)
    with open(path + ".json", "w") as file:
        json.dump({"pitch_m": 8e-6, "wavelengths_m": [532e-9], "z_m": 0}, file)
    return path


class OfServer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="holotrace_server_")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        with open(os.path.join(cls.folder, "secret.txt"), "w") as file:
            file.write("secret")
        cls.server = Server(cls.folder)
        cls.addClassCleanup(cls.server.stop)

    def test_serves_its_page(self):
        self.assertEqual(self.server.ask(), 200)
        self.assertEqual(self.server.ask("session"), 200)
        self.assertEqual(self.server.ask("view"), 400)  # an empty folder

    def test_wants_the_token(self):
        token = self.server.token
        for wrong in ("", "a", token[:-1], token + "0", token.upper() if token.upper() != token else "0" * 64,
                      token[::-1], "0" * 64, "%00" + token):
            self.assertEqual(self.server.ask(token=wrong), 403, wrong)
        self.assertEqual(self.server.send(f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{self.server.port}\r\n\r\n".encode()), 403)

    def test_refuses_foreign_hosts_and_origins(self):
        for host in ("evil.example", f"evil.example:{self.server.port}", "127.0.0.1", "127.0.0.1:1"):
            self.assertEqual(self.server.ask(host=host), 403, host)
        for origin in ("http://evil.example", "null", "https://127.0.0.1"):
            self.assertEqual(self.server.ask(more=f"Origin: {origin}\r\n"), 403, origin)
        self.assertEqual(self.server.ask(more="Sec-Fetch-Site: cross-site\r\n"), 403)
        self.assertEqual(self.server.send(f"GET /{self.server.token}/ HTTP/1.1\r\n\r\n".encode()), 403)  # no host

    def test_leaves_no_folder(self):
        for path in ("secret.txt", "../secret.txt", "..%2fsecret.txt", "%2e%2e%2fsecret.txt", "....//secret.txt",
                     "..\\secret.txt", "/etc/passwd", "../../../../etc/passwd", "%2fetc%2fpasswd", "..;/etc/passwd",
                     "view.png/../secret.txt", "%c0%ae%c0%ae/secret.txt"):
            self.assertIn(self.server.ask(path), (400, 404), path)

    def test_bounds_requests(self):
        self.assertEqual(self.server.ask(more="A: " + "a" * 20000 + "\r\n"), 431)
        self.assertEqual(self.server.ask(more="".join(f"A{i}: b\r\n" for i in range(5000))), 431)
        self.assertEqual(self.server.ask("view?" + "a" * 20000), 431)
        self.assertEqual(self.server.ask("view?" + "a" * 5000), 400)
        self.assertEqual(self.server.ask(more="Content-Length: 99999999999999999999\r\n", method="POST"), 413)
        self.assertEqual(self.server.ask(method="POST"), 405)
        self.assertEqual(self.server.ask(method="PUT"), 405)
        self.assertEqual(self.server.send(b"\x16\x03\x01\x02\x00\x01\x00\r\n\r\n"), 400)  # TLS
        self.assertEqual(self.server.ask(more="Range: bytes=" + "0-," * 2000 + "0-\r\n"), 200)  # not looked at
        before = self.server.memory()
        self.assertEqual(self.server.send(b"GET /" + b"a" * 50_000_000), 431)  # a line without an end
        self.assertLess(self.server.memory() - before, 10 + KEPT_BY_SANITIZER)  # 50 MB were sent

    def test_serves_others_beside_slow_clients(self):
        slow = [socket.create_connection(("127.0.0.1", self.server.port)) for _ in range(200)]
        for i, connection in enumerate(slow):
            try:
                connection.sendall(b"GET / HTTP/1.1\r\n"[:1 + i % 16])
            except OSError:  # closed for newer ones
                pass
        start = time.time()
        self.assertEqual(self.server.ask(), 200)
        self.assertLess(time.time() - start, 10)  # long before 200 clients have used up their 5 s each
        for connection in slow:
            connection.close()

    def test_survives_a_burst(self):
        good = [0] * 8

        def ask(place):
            for i in range(1250):
                good[place] += self.server.ask("session" if i % 2 else "none") == (200 if i % 2 else 404)

        before = self.server.memory()
        clients = [threading.Thread(target=ask, args=(place,)) for place in range(8)]
        for client in clients:
            client.start()
        for client in clients:
            client.join()
        self.assertEqual(sum(good), 10000)
        self.assertLess(self.server.memory() - before, 30 + KEPT_BY_SANITIZER)  # stacks and buffers of at most 128 threads


class OfProgram(unittest.TestCase):
    def test_ends_when_nobody_looks(self):
        with tempfile.TemporaryDirectory() as folder:
            server = Server(folder, "--idle", "1 s")
            server.process.communicate(timeout=20)
            self.assertEqual(server.process.returncode, 0)

    def test_ends_with_the_program_that_embeds_it(self):
        with tempfile.TemporaryDirectory() as folder:
            for arguments, ends in ((("--embed",), True), ((), False)):
                server = Server(folder, *arguments, stdin=subprocess.PIPE)
                server.process.stdin.write("more\n")  # what it is sent does not matter
                server.process.stdin.flush()
                time.sleep(0.5)
                self.assertIsNone(server.process.poll())
                self.assertEqual(server.ask(), 200)
                server.process.stdin.close()
                server.process.stdin = None
                if ends:
                    server.process.communicate(timeout=20)
                    self.assertEqual(server.process.returncode, 0)
                else:
                    time.sleep(0.5)
                    self.assertEqual(server.ask(), 200)
                    self.assertEqual(server.stop(), 0)

    def test_says_that_a_hologram_is_too_large(self):
        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        side = 300000  # 180 GB of levels
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "hologram.png"), "wb") as file:
                file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)) +
                           chunk(b"IDAT", zlib.compress(b"\0" * 1000)) + chunk(b"IEND", b""))
            server = Server(folder)
            self.addCleanup(server.stop)
            with urllib.request.urlopen(server.url + "session") as answer:
                problems = json.load(answer)["problems"]
            self.assertIn("its header claims 300000 × 300000 pixels", problems[0])
            self.assertEqual(server.ask("view"), 400)

    def test_ends_on_interrupt(self):
        with tempfile.TemporaryDirectory() as folder:
            server = Server(folder)
            self.assertEqual(server.stop(), 0)

    def test_ends_at_once_while_it_computes(self):
        with tempfile.TemporaryDirectory() as folder:
            server = Server(field_in(folder, 1024))
            # A sensor of 25 million pixels takes many seconds.
            asking = threading.Thread(target=server.ask,
                                      args=("view?distance=100+mm&width=5+mm&height=5+mm&pixel=1+um",))
            asking.start()
            time.sleep(0.5)
            start = time.monotonic()
            self.assertEqual(server.stop(), 0)
            self.assertLess(time.monotonic() - start, 5)  # the picture alone takes longer; less on an idle machine
            asking.join()

    # Each thread that computes leaves memory behind in libraries: views of short-lived threads took 6 KiB each.
    def test_memory_does_not_grow_by_requests(self):
        with tempfile.TemporaryDirectory() as folder:
            server = Server(field_in(folder, 64))
            self.addCleanup(server.stop)
            ask = lambda i: server.ask(f"view?draft=1&distance={100 + i % 7}+mm")  # noqa: E731
            for i in range(200):
                self.assertEqual(ask(i), 200)
            before = server.memory()
            workers = [threading.Thread(target=lambda k=k: [ask(8 * i + k) for i in range(250)]) for k in range(8)]
            for worker in workers:
                worker.start()
            for worker in workers:
                worker.join()
            self.assertLess(server.memory() - before, 4 + KEPT_BY_SANITIZER)  # 2000 requests of 2 KiB

    def test_listens_on_the_loopback_address_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            server = Server(folder)
            with open("/proc/net/tcp") as file:
                listening = [line.split()[1] for line in file if line.split()[3] == "0A"]
            self.assertIn(f"0100007F:{server.port:04X}", listening)
            self.assertNotIn(f"00000000:{server.port:04X}", listening)
            server.stop()

    def test_warns_of_other_addresses(self):
        with tempfile.TemporaryDirectory() as folder:
            server = Server(folder, "--address", "0.0.0.0")
            server.process.send_signal(signal.SIGINT)
            self.assertIn("warning: the server listens on 0.0.0.0: everybody on that network",
                          server.process.communicate(timeout=20)[1])

    def test_says_what_is_wrong(self):
        with tempfile.TemporaryDirectory() as folder:
            server = Server(folder)
            self.addCleanup(server.stop)
            for arguments, expected in (
                    ([folder, "--port", str(server.port)], "Address already in use"),
                    ([folder, "--port", "99999"], "--port: expected a whole number from 0 to 65535, got 99999"),
                    ([folder, "--idle", "30"], '--idle: expected a time of 1 s or more with its unit (s, min or h), got "30"'),
                    ([folder, "--address", "example.org"], "expected an address in digits")):
                run = subprocess.run([PROGRAM, "view", "--no-browser", *arguments], capture_output=True, text=True,
                                     timeout=20)
                self.assertEqual(run.returncode, 1, arguments)
                self.assertIn(expected, run.stderr)
                self.assertEqual(run.stdout, "")


if __name__ == "__main__":
    unittest.main(argv=["server_test.py", *sys.argv[1:]], verbosity=2)
