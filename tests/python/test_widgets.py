"""holotrace.widgets: the page of the program's server, in a frame of a notebook, and how the server ends."""

import json
import os
import re
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request

import numpy as np
import pytest

import holotrace as ht
from test_views import hologram_at


def session_of(viewer):
    """What the server says of what it shows."""
    with urllib.request.urlopen(viewer.url + "session") as answer:
        return json.load(answer)


def is_gone(url):
    try:
        urllib.request.urlopen(url, timeout=5)
    except (urllib.error.URLError, ConnectionError):
        return True
    return False


def wait_until_gone(url):
    end = time.monotonic() + 20
    while not is_gone(url):
        assert time.monotonic() < end, "the server is still there"
        time.sleep(0.05)


def test_holograms_in_memory_are_shown_in_a_frame():
    with ht.widgets.viewer([hologram_at(532e-9), hologram_at(638e-9, 2)], height=321) as viewer:
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[0-9a-f]{64}/", viewer.url)
        page = viewer._repr_html_()
        assert f'<iframe src="{viewer.url}"' in page and 'height="321"' in page
        assert f"Viewer at {viewer.url}; open this address in a browser" in repr(viewer)
        session = session_of(viewer)
        assert [one["wavelengths_m"] for one in session["items"]] == [[532e-9], [638e-9]] and not session["problems"]
        with urllib.request.urlopen(viewer.url) as answer:
            assert "frame-ancestors http://localhost:*" in answer.headers["Content-Security-Policy"]
        folder = viewer._folder.name
        assert sorted(os.listdir(folder)) == ["hologram_1.png", "hologram_2.png"]
    assert is_gone(viewer.url) and not os.path.exists(folder)
    viewer.close()  # once more does no harm


def test_files_and_runs_are_shown(tmp_path):
    hologram_at(532e-9).save(tmp_path / "hologram.png")
    for shown in (tmp_path, str(tmp_path / "hologram.png"), [hologram_at(638e-9), tmp_path / "hologram.png"]):
        with ht.widgets.viewer(shown) as viewer:
            wavelengths = [one["wavelengths_m"] for one in session_of(viewer)["items"]]
            assert wavelengths == ([[638e-9], [532e-9]] if isinstance(shown, list) else [[532e-9]])
    scene = ht.Scene(wavelength="532 nm", slm={"preset": "pluto", "columns": 32, "rows": 24}, trace={"columns": 8, "rows": 8, "paths": 1},
                     object=[{"type": "quad", "width": "2 mm", "height": "2 mm", "position": (0, 0, -0.1)}],
                     light=[{"type": "directional", "direction": [0, 0, -1], "irradiance": 3}])
    with ht.widgets.viewer(ht.run(scene, render={"rows": 16, "paths": 1})) as viewer:
        assert session_of(viewer)["kind"] == "folder"


def test_the_server_ends_with_its_process(tmp_path):
    """However that ends: at its last line, or killed, which runs no line of it."""
    hologram_at(532e-9).save(tmp_path / "hologram.png")
    text = f"import holotrace as ht, sys; print(ht.widgets.viewer({str(tmp_path)!r}).url, flush=True); sys.stdin.read()"
    for end in (lambda process: process.stdin.close(), lambda process: process.send_signal(signal.SIGKILL)):
        process = subprocess.Popen([sys.executable, "-c", text], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        url = process.stdout.readline().strip()
        assert not is_gone(url)
        end(process)
        process.wait(timeout=60)
        process.stdout.close()
        wait_until_gone(url)


def test_an_interrupt_of_the_cell_leaves_the_server(tmp_path):
    hologram_at(532e-9).save(tmp_path / "hologram.png")
    with ht.widgets.viewer(tmp_path) as viewer:
        assert os.getpgid(viewer._server.pid) != os.getpgid(0)


def test_an_interrupt_while_files_are_read_ends_the_server(tmp_path, monkeypatch):
    """A program that never gets ready stands for one that reads long. Without its end, the call would wait for it."""
    program = tmp_path / "holotrace"
    program.write_text("#!/bin/sh\nexec sleep 600\n")
    program.chmod(0o755)
    monkeypatch.setenv("HOLOTRACE_PROGRAM", str(program))

    def interrupt(*arguments):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 0.3)
    try:
        with pytest.raises(KeyboardInterrupt):
            ht.widgets.viewer(tmp_path)
    finally:
        signal.signal(signal.SIGALRM, before)


def test_a_notebook_shows_the_frame(tmp_path):
    nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed; scripts/setup --tests installs it")
    nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed; scripts/setup --tests installs it")
    pytest.importorskip("ipykernel", reason="ipykernel is not installed; scripts/setup --tests installs it")
    hologram_at(532e-9).save(tmp_path / "hologram.png")
    cell = nbformat.v4.new_code_cell('import holotrace as ht\nht.widgets.viewer(".")')
    notebook = nbformat.v4.new_notebook(cells=[cell])
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    (output,) = notebook.cells[0].outputs
    url = re.search(r'<iframe src="([^"]*)"', output["data"]["text/html"])[1]
    assert url in output["data"]["text/plain"]
    wait_until_gone(url)  # with the kernel


def test_what_cannot_be_shown_is_an_error_in_words(tmp_path, monkeypatch, program_error):
    sentence = program_error("view", "--no-browser", tmp_path / "none.png")
    with pytest.raises(ht.Error) as error:
        ht.widgets.viewer(tmp_path / "none.png")
    assert str(error.value) == sentence
    with pytest.raises(ht.Error, match="expected a Hologram to view, got Image"):
        ht.widgets.viewer([ht.Image(np.ones((2, 2)))])
    with pytest.raises(ht.Error, match="expected the folder of a run, or holograms, to view, got int"):
        ht.widgets.viewer(3)
    monkeypatch.delenv("HOLOTRACE_PROGRAM")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr("sysconfig.get_path", lambda name: str(tmp_path))
    with pytest.raises(ht.Error, match="expected the program holotrace beside this Python or on the PATH, but there is none; install"):
        ht.widgets.viewer(tmp_path)


def test_a_scene_is_shown_live(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text('wavelength = "532 nm"\n[slm]\ncolumns = 32\nrows = 24\n[[light]]\ntype = "directional"\ndirection = [0, 0, -1]\n'
                    'irradiance = 3\n[[object]]\ntype = "quad"\nwidth = "2 mm"\nheight = "2 mm"\nposition = "0 0 -100 mm"\n')
    with ht.widgets.viewer(path, live=True) as viewer:
        assert "object.1.position" in [one["key"] for one in session_of(viewer)["live"]]
    with pytest.raises(ht.Error, match="expected the path of a scene to view live"):
        ht.widgets.viewer([path], live=True)
