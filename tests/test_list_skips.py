#!/usr/bin/env python3
"""The list of skipped tests: python3 test_list_skips.py."""

import os
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
LOG = """\
1/2 Testing: wave.Kernels.Bf16
[ RUN      ] Kernels.Bf16
/x/test_kernels.cpp:57: Skipped
this processor has no products of bf16 numbers
[  SKIPPED ] Kernels.Bf16 (0 ms)
<end of output>
2/2 Testing: python.waves
SKIPPED [1] tests/python/test_waves.py:9: jax is not installed; pip install jax
<end of output>
"""


def run(log, unavailable="", **environment):
    with tempfile.TemporaryDirectory() as folder:
        paths = [os.path.join(folder, name) for name in ("LastTest.log", "unavailable")]
        for path, text in zip(paths, (log, unavailable)):
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
        return subprocess.run([sys.executable, os.path.join(HERE, "list_skips.py"), *paths], capture_output=True, text=True,
                              env={**os.environ, "CI": "", **environment}, check=False)


class Skips(unittest.TestCase):
    def test_are_listed_with_their_reasons(self):
        lines = run(LOG).stdout.splitlines()
        self.assertEqual(lines[0], "2 tests skipped, 1 of them unexpectedly")
        self.assertEqual(lines[1], "  expected: wave.Kernels.Bf16: this processor has no products of bf16 numbers")
        self.assertIn("python.waves (tests/python/test_waves.py:9): jax is not installed", lines[2])

    def test_fail_in_ci_if_something_was_not_installed(self):
        self.assertEqual(run(LOG).returncode, 0)
        self.assertEqual(run(LOG, CI="true").returncode, 1)
        self.assertEqual(run(LOG, "jax==0.4.30 torch\n", CI="true").returncode, 0)
        self.assertEqual(run(LOG, "torch\n", CI="true").returncode, 1)
        self.assertEqual(run(LOG.split("2/2")[0], CI="true").returncode, 0)


if __name__ == "__main__":
    unittest.main()
