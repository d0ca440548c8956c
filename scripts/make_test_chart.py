#!/usr/bin/env python3
"""Draws examples/test_chart.png: bars, a star, grey steps, a smooth ball and text, to judge holograms.

Usage: scripts/make_test_chart.py [OUTPUT.png]    needs Pillow and NumPy
"""
import pathlib
import sys

import numpy as np
from PIL import Image, ImageDraw, ImageFont

SIDE = 512
FINE = 4  # drawn larger by this factor, then averaged
FONT = "DejaVuSans-Bold.ttf"


def square(x, y, side):
    """Pixel box at a fraction of the chart."""
    return [int(v * SIDE * FINE) for v in (x, y, x + side, y + side)]


def draw_star(image, x, y, side, spokes=16):
    left, top, right, bottom = square(x, y, side)
    v, u = np.mgrid[top:bottom, left:right].astype(float)
    u, v = u - (left + right) / 2, v - (top + bottom) / 2
    star = np.where(np.sin(spokes * np.arctan2(v, u)) > 0, 245, 10)
    inside = np.hypot(u, v) < (right - left) / 2
    image[top:bottom, left:right][inside] = star[inside]


def draw_ball(image, x, y, side):
    """A matt ball lit from the upper left on a soft background: smooth greys, as in a photograph."""
    left, top, right, bottom = square(x, y, side)
    v, u = np.mgrid[-1 : 1 : (bottom - top) * 1j, -1 : 1 : (right - left) * 1j]
    backdrop = 70 + 60 * (1 - v) / 2
    shadow = np.clip(1 - np.hypot((u - 0.25) / 0.75, (v - 0.75) / 0.22), 0, 1)
    picture = backdrop * (1 - 0.8 * shadow)
    radius = np.hypot(u, v + 0.05) / 0.75
    normal = np.sqrt(np.clip(1 - radius**2, 0, 1))
    light = np.clip(-0.5 * u / 0.75 - 0.6 * (v + 0.05) / 0.75 + 0.62 * normal, 0, 1)
    picture = np.where(radius < 1, 25 + 215 * light, picture)
    image[top:bottom, left:right] = picture


def draw_bars(image, x, y, width, height, pixels):
    """Vertical and, below, horizontal bars of `pixels` chart pixels each."""
    left, top = int(x * SIDE) * FINE, int(y * SIDE) * FINE
    w, h, p = int(width * SIDE) * FINE, int(height * SIDE) * FINE, pixels * FINE
    columns, rows = np.arange(w) // p % 2 == 0, np.arange(h) // p % 2 == 0
    image[top : top + h, left : left + w] = np.where(columns, 245, 10)[None, :]
    image[top + h : top + 2 * h, left : left + w] = np.where(rows, 245, 10)[:, None]


def main():
    image = np.full((SIDE * FINE, SIDE * FINE), 110.0)
    for i, pixels in enumerate((16, 8, 6, 4)):
        draw_bars(image, 0.05 + 0.1325 * i, 0.22, 0.125, 0.125, pixels)
    draw_star(image, 0.61, 0.16, 0.35)
    draw_ball(image, 0.05, 0.52, 0.40)
    for i in range(8):
        left, top, right, _ = square(0.50 + 0.0575 * i, 0.80, 0.0575)
        image[top : int(0.92 * SIDE * FINE), left:right] = 255 * i / 7

    picture = Image.fromarray(image.clip(0, 255).astype(np.uint8))
    draw = ImageDraw.Draw(picture)
    draw.text((SIDE * FINE * 0.05, SIDE * FINE * 0.115), "HOLOTRACE", 250, ImageFont.truetype(FONT, int(0.105 * SIDE * FINE)), "lm")
    draw.text((SIDE * FINE * 0.50, SIDE * FINE * 0.60), "300 mm", 250, ImageFont.truetype(FONT, int(0.085 * SIDE * FINE)), "lm")
    draw.text((SIDE * FINE * 0.50, SIDE * FINE * 0.715), "632.8 nm", 10, ImageFont.truetype(FONT, int(0.07 * SIDE * FINE)), "lm")
    edge = FINE * 6
    draw.rectangle([0, 0, SIDE * FINE - 1, SIDE * FINE - 1], outline=250, width=edge)
    default = pathlib.Path(__file__).resolve().parent.parent / "examples" / "test_chart.png"
    picture.resize((SIDE, SIDE), Image.Resampling.BOX).save(sys.argv[1] if len(sys.argv) > 1 else default, optimize=True)


if __name__ == "__main__":
    main()
