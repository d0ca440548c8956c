"""What all verbs have in common: signatures from the one list, progress, interruption, threads, fork, memory."""

import inspect
import os
import resource
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import holotrace as ht
from holotrace import _core
from conftest import random_samples


def verbs():
    return {name: verb for name, verb in vars(ht).items() if hasattr(verb, "__holotrace_stage__")}


def test_verbs_have_the_parameters_of_their_stage_with_their_defaults():
    assert len(verbs()) >= 12
    for verb in verbs().values():
        stage, without, of_scene = verb.__holotrace_stage__
        parameters = inspect.signature(verb).parameters
        for one in _core.parameters()[stage]:
            if one["name"] in without:
                continue
            assert parameters[one["name"]].default == (None if of_scene else one["value"]), one["name"]
            assert f'{one["name"]} : ' in verb.__doc__ and one["help"].split()[0] in verb.__doc__


def test_the_lists_are_those_of_the_command_line(program):
    """--help is made from the same lists in data/params/: each flag of propagate is a keyword, and nothing else is."""
    first = [line.split()[0] for line in program("propagate", "--help").splitlines() if line.strip()]
    flags = {word[2:].replace("-", "_") for word in first if word.startswith("--")}
    names = {one["name"] for one in _core.parameters()["propagate"]}
    assert names <= flags
    assert flags - names <= {"help", "version", "threads", "quiet", "allow_outside", "output", "distance", "double", "report"}


WAVES = ht.Sources(
    np.column_stack([np.zeros((100, 2)), np.linspace(-0.2, -0.1, 100)]), wavelength=532e-9)


def test_progress_is_called_with_the_stage_and_a_fraction():
    seen = []
    ht.synthesize(WAVES, ht.Slm(columns=400, rows=400, pitch=8e-6), method="exact",
                  progress=lambda stage, fraction: seen.append((stage, fraction)))
    assert seen and all(stage == "synthesize" and 0 <= fraction <= 1 for stage, fraction in seen)


def test_an_exception_in_the_callback_stops_the_verb():
    def stop(stage, fraction):
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        ht.synthesize(WAVES, ht.Slm(columns=400, rows=400, pitch=8e-6), method="exact", progress=stop)


def long_sum():
    waves = np.column_stack([np.zeros((200_000, 2)), np.linspace(-0.2, -0.1, 200_000)])
    return ht.synthesize(ht.Sources(waves, wavelength=532e-9), "pluto", method="exact")


def long_render():
    square = {"type": "quad", "width": "5 mm", "height": "5 mm", "position": (0, 0, -0.1)}
    light = {"type": "point", "position": (0, 0, -0.05), "intensity": 0.01}
    return ht.render(ht.Scene(wavelength="532 nm", object=[square], light=[light]), rows=4000, paths=100_000)


@pytest.mark.parametrize("verb", [long_sum, long_render])
def test_ctrl_c_stops_a_long_verb(verb):
    """They would take minutes or more. No timing is asserted: a verb that is not stopped runs into the timeout."""
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        verb()


def test_other_threads_run_while_a_verb_works():
    """The GIL is released: a thread counts while the sum works."""
    counted = []
    done = threading.Event()

    def count():
        while not done.is_set():
            counted.append(1)
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before = len(counted)
    ht.synthesize(WAVES, ht.Slm(columns=400, rows=400, pitch=8e-6), method="exact")
    after = len(counted)
    done.set()
    thread.join()
    assert after > before + 2


def test_verbs_in_several_threads_give_the_same_result(field):
    expected = ht.propagate(field, 0.02).samples.tobytes()
    results = []
    threads = [
        threading.Thread(target=lambda: results.append(ht.propagate(field, 0.02).samples.tobytes())) for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [expected] * 8


def test_a_forked_process_can_work(field):
    """multiprocessing forks by default on Linux; the parent's threads do not exist in the child."""
    expected = ht.propagate(field, 0.02).samples.tobytes()
    child = os.fork()
    if child == 0:
        os._exit(0 if ht.propagate(field, 0.02).samples.tobytes() == expected else 1)
    for _ in range(600):
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            break
        time.sleep(0.05)
    else:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        pytest.fail("the child hangs")
    assert status == 0


def test_ten_thousand_calls_leak_nothing():
    """Objects, arrays and results of 1e4 calls: each leak of one 8 x 8 field of 512 bytes would be 5 MB."""
    samples = random_samples((8, 8))

    def work(calls):
        for _ in range(calls):
            field = ht.propagate(ht.Field(samples, 8e-6, 532e-9), 1e-4)
            np.asarray(field).sum()
            ht.Sources([[0, 0, -0.1]], wavelength=532e-9).copy()
            try:
                ht.propagate(field, "1 yard")
            except ht.Error:
                pass

    work(1000)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    work(10_000)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 2048  # kB


def test_the_module_reports_no_leak_at_exit():
    """nanobind reports objects that are alive at exit on stderr."""
    code = "import holotrace as ht, numpy as np; ht._core.set_leak_warnings(True); f = ht.propagate(ht.Field(np.ones((8, 8)), 8e-6, 5e-7), 1e-4)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_importing_does_not_load_mpi_or_torch():
    code = "import sys, holotrace; print('torch' in sys.modules, any('libmpi' in m for m in open('/proc/self/maps')))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.split() == ["False", "False"]


def test_results_do_not_depend_on_the_number_of_threads(field):
    expected = ht.propagate(field, 0.02).samples.tobytes()
    ht.set_threads(1)
    try:
        assert ht.propagate(field, 0.02).samples.tobytes() == expected
    finally:
        ht.set_threads(0)
