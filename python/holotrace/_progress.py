"""Progress of verbs, and what they warn of."""

from __future__ import annotations

import sys
import time
import warnings
from contextlib import contextmanager
from typing import Any, Callable, Dict, Iterator, Optional, Union

from . import _core
from ._checked import count

#: None: a bar in terminals and notebooks, by tqdm if it is installed. False: none. Or a function of the stage's name and
#: the fraction that is done; it is called about 20 times a second.
Progress = Union[None, bool, Callable[[str, float], Any]]


class ResultWarning(UserWarning):
    """A doubt about a result, such as light that was left out."""


def _is_shown() -> bool:
    return "ipykernel" in sys.modules or (sys.stderr is not None and sys.stderr.isatty())


class _Bar:
    """A bar of tqdm for each stage. It appears after half a second: short work shows none."""

    def __init__(self) -> None:
        self._begin = time.monotonic()
        self._stage = ""
        self._bar: Any = None

    def __call__(self, stage: str, fraction: float, status: str) -> None:
        if time.monotonic() - self._begin < 0.5:
            return
        if stage != self._stage:
            self.close()
            self._stage = stage
            try:
                with warnings.catch_warnings():  # in notebooks without ipywidgets the bar is of text
                    warnings.simplefilter("ignore")
                    from tqdm.auto import tqdm
            except ImportError:
                return
            self._bar = tqdm(total=100, desc=stage, bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}{postfix}")
        if self._bar is not None:
            self._bar.n = round(100 * fraction, 1)
            if status:
                self._bar.set_postfix_str(status, refresh=False)
            self._bar.refresh()

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None


class Watched:
    """What a verb states while it works."""

    def __init__(self, core: Any) -> None:
        self.core = core

    @property
    def facts(self) -> Dict[str, Any]:
        facts: Dict[str, Any] = {**self.core.facts, **self.core.curves}
        return facts


def set_threads(number: int) -> None:
    """The number of threads that verbs use; 0: all. Results do not depend on it."""
    _core.set_threads(count(number, "threads"))


@contextmanager
def watching(progress: Progress, level: int = 4) -> Iterator[Watched]:
    """The core's watch for one call of a verb. Warnings are issued at its end, for the line that called the verb."""
    bar = _Bar() if progress is True or (progress is None and _is_shown()) else None
    callback: Optional[Callable[[str, float, str], Any]] = bar
    if callable(progress):
        given = progress
        callback = lambda stage, fraction, status: given(stage, fraction)  # noqa: E731
    watched = Watched(_core.Watch(callback))
    try:
        yield watched
    finally:
        if bar is not None:
            bar.close()
    for sentence in watched.core.warnings:
        warnings.warn(sentence, ResultWarning, stacklevel=level)
