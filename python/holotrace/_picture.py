"""Small pictures for notebooks."""

from __future__ import annotations

import base64
import html
import struct
import zlib
from typing import Any, Iterable, Tuple

import numpy as np

_MOST = 384  # pixels along the longer side


def png(pixels: np.ndarray[Any, Any]) -> bytes:
    """8-bit pixels of the shape (rows, columns) or (rows, columns, 3) as the bytes of a PNG."""
    rows, columns = pixels.shape[:2]
    colour_type = 2 if pixels.ndim == 3 else 0

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    lines = np.zeros((rows, 1 + pixels[0].size), np.uint8)  # each line begins with 0: no filter
    lines[:, 1:] = pixels.reshape(rows, -1)
    header = struct.pack(">IIBBBBB", columns, rows, 8, colour_type, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(lines.tobytes(), 6))
        + chunk(b"IEND", b"")
    )


def reduced(values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Means over blocks of pixels, so that a picture is small."""
    step = -(-max(values.shape[:2]) // _MOST)
    if step == 1:
        return values
    rows, columns = (max(1, n // step) for n in values.shape[:2])
    high, wide = min(step, values.shape[0]), min(step, values.shape[1])
    cut = values[: rows * high, : columns * wide]
    blocks = cut.reshape((rows, high, columns, wide) + values.shape[2:])
    mean: np.ndarray[Any, Any] = blocks.mean(axis=(1, 3))
    return mean


def grey(light: np.ndarray[Any, Any], white: float) -> np.ndarray[Any, Any]:
    """Linear light as 8-bit sRGB values."""
    linear = np.clip(light / (white if white > 0 else 1.0), 0, 1)
    coded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return (255 * coded + 0.5).astype(np.uint8)


def turns(phase: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """A phase [rad] as 8-bit grey: one turn from black to white."""
    return (phase % (2 * np.pi) * (255 / (2 * np.pi)) + 0.5).astype(np.uint8)


def page(title: str, pictures: Iterable[Tuple[str, np.ndarray[Any, Any]]]) -> str:
    """Pictures with their captions, as HTML for a notebook."""
    shown = "".join(
        '<figure style="display:inline-block;margin:4px"><img src="data:image/png;base64,'
        + base64.b64encode(png(pixels)).decode("ascii")
        + f'" alt="{html.escape(caption)}"/><figcaption>{html.escape(caption)}</figcaption></figure>'
        for caption, pixels in pictures
    )
    return f"<div><code>{html.escape(title)}</code><br/>{shown}</div>"
