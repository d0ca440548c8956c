"""The page of ``holotrace view`` inside a notebook::

    import holotrace as ht

    ht.widgets.viewer("out/chess")  # at the end of a cell

The program's server stands behind it, on this machine, and ends with the kernel.
"""

from __future__ import annotations

import atexit
import html
import os
import shutil
import subprocess
import sysconfig
import tempfile
from typing import Any, List, Sequence, Union

from . import _core
from ._checked import count, items
from ._encode import Run
from ._fields import Path
from ._holograms import Hologram
from ._waves import a

__all__ = ["Viewer", "viewer"]


def _program() -> str:
    """The program: that of HOLOTRACE_PROGRAM, else the one that was installed with this package, else the one on the path."""
    beside = shutil.which("holotrace", path=sysconfig.get_path("scripts"))
    found = os.environ.get("HOLOTRACE_PROGRAM") or beside or shutil.which("holotrace")
    if not found:
        raise _core.Error(
            "expected the program holotrace beside this Python or on the PATH, but there is none; install the package"
            " with pip, or set HOLOTRACE_PROGRAM to the program's path"
        )
    return found


class Viewer:
    """A page that shows holograms live, with the server behind it on this machine.

    In a notebook it shows itself. The server ends with ``close()``, at the end of a ``with`` block, and with this process.
    """

    def __init__(self, paths: Sequence[str], height: int, port: int, folder: Any = None) -> None:
        #: Address of the page, which a browser on this machine opens.
        self.url: str = ""
        self.height = height
        self._folder = folder
        command = [_program(), "--quiet", "view", "--no-browser", "--embed", "--idle", "2000 h", "--port", str(port), *paths]
        with tempfile.TemporaryFile() as said:
            # A session of its own: an interrupt of the cell that runs does not reach it.
            self._server = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=said, start_new_session=True
            )
            atexit.register(self.close)
            try:
                self.url = self._server.stdout.readline().decode().strip()  # type: ignore[union-attr]
            finally:
                if not self.url:
                    self.close()
            if not self.url:
                said.seek(0)
                raise _core.Error(said.read().decode(errors="replace").strip().removeprefix("holotrace: "))

    def close(self) -> None:
        """End the server. The page shows nothing more."""
        atexit.unregister(self.close)
        self._server.terminate()
        self._server.communicate()
        if self._folder is not None:
            self._folder.cleanup()

    def __enter__(self) -> "Viewer":
        return self

    def __exit__(self, *error: Any) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"Viewer at {self.url}; open this address in a browser on this machine, and end it with .close()"

    def _repr_html_(self) -> str:
        return (
            f'<iframe src="{html.escape(self.url)}" width="100%" height="{self.height}" style="border: 0"'
            ' allow="clipboard-write" title="Holotrace viewer"></iframe>'
        )


def viewer(
    shown: Union[Path, Run, Hologram, Sequence[Union[Path, Hologram]]],
    height: int = 600,
    *,
    port: int = 0,
    live: bool = False,
) -> Viewer:
    """The page of ``holotrace view`` as a part of a notebook: focus with the mouse wheel, move the eye, switch effects.

    Outside notebooks, open the address ``.url`` of what is returned in a browser. If Python runs on another machine than the
    browser, first forward the port: ``ssh -L 8080:127.0.0.1:8080 MACHINE`` for ``port=8080``.

    Parameters
    ----------
    shown : path, Run, Hologram, or a sequence of paths and holograms
        The folder of a run, or what else ``holotrace view`` shows: holograms, a field, sources or a scene. Runs and holograms in
        memory are saved into a temporary folder.
    height : whole number
        Height of the page in the notebook, in pixels.
    port : whole number
        Port of the server; 0: one that is free.
    live : bool
        Whether the values of a scene may be changed in the page; its hologram follows.
    """
    height, port = count(height, "height", least=1), count(port, "port", most=65535)
    if isinstance(shown, (str, os.PathLike)):
        return Viewer([os.fspath(shown), *(["--live"] if live else [])], height, port)
    if live:
        raise _core.Error("expected the path of a scene to view live; leave out live")
    folder = tempfile.TemporaryDirectory(prefix="holotrace_viewer_")
    if isinstance(shown, Run):
        shown.save(folder.name)
        return Viewer([folder.name], height, port, folder)
    given = [shown] if isinstance(shown, Hologram) else items(shown, "the folder of a run, or holograms, to view")
    paths: List[str] = []
    for number, one in enumerate(given, 1):
        if isinstance(one, (str, os.PathLike)):
            paths.append(os.fspath(one))
        else:
            paths.append(os.path.join(folder.name, f"hologram_{number}.png"))
            a(Hologram, one, "to view").save(paths[-1])
    return Viewer(paths, height, port, folder)
