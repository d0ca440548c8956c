"""Lists the tests that the last run of CTest skipped, with their reasons.

Usage: list_skips.py LastTest.log [UNAVAILABLE]

Expected are tests for hardware that this machine has not, for rights that its user has not, tests that a sanitizer
cannot run, and tests of the packages in the file UNAVAILABLE, which scripts/setup could not install. If CI is "true" in the environment, any other skip ends with exit code 1: something was not installed.
"""

import os
import re
import sys

EXPECTED = (
    r"this processor has no",
    r"the system (names no processor|lists no features)",
    r"(root|the superuser) may write everywhere",
    r"by root only|only root can",
    r"may not watch programs",
    r"sanitizer",
    r"the site was not built",  # its own test says why
)


def skips(log):
    """Names and reasons of skipped tests, as GoogleTest, pytest and this project's scripts print them."""
    for test in re.split(r"^\d+/\d+ Testing: ", log, flags=re.M)[1:]:
        name, body = test.split("\n", 1)
        for reason in re.findall(r"^\S+:\d+: Skipped\n(.*)", body, flags=re.M):
            yield name, reason
        for place, reason in re.findall(r"^SKIPPED \[\d+\] (\S+): (.*)", body, flags=re.M):
            yield f"{name} ({place})", reason
        for reason in re.findall(r"^skipped: (.*)", body, flags=re.M):
            yield name, reason


def unavailable(path):
    """Patterns of the packages that a file names: "jax==0.4.30 torch"."""
    if not os.path.exists(path):
        return ()
    with open(path, encoding="utf-8") as file:
        return tuple(f"^{re.escape(name.split('==')[0])} is not installed" for name in file.read().split())


def main():
    with open(sys.argv[1], encoding="utf-8", errors="replace") as file:
        found = list(skips(file.read()))
    expected = EXPECTED + (unavailable(sys.argv[2]) if len(sys.argv) > 2 else ())
    unexpected = [skip for skip in found if not any(re.search(pattern, skip[1]) for pattern in expected)]
    print(f"{len(found)} tests skipped, {len(unexpected)} of them unexpectedly")
    for name, reason in found:
        print(f"  {'' if (name, reason) in unexpected else 'expected: '}{name}: {reason}")
    return 1 if unexpected and os.environ.get("CI") == "true" else 0


if __name__ == "__main__":
    sys.exit(main())
