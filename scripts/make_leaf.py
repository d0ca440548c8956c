#!/usr/bin/env python3
"""Draws examples/leaf.png: a leaf, with an alpha that cuts it out of its square.

Usage: scripts/make_leaf.py [OUTPUT.png]    needs Pillow and NumPy
"""
import pathlib
import sys

import numpy as np
from PIL import Image

SIDE = 128
FINE = 4  # its outline is drawn larger by this factor, then averaged


def places(side):
    """From -1 to 1 across the square, and along the leaf: 0 at its base, 1 at its tip."""
    y, x = np.mgrid[0:side, 0:side]
    x, y = (x + 0.5) / side * 2 - 1, 1 - (y + 0.5) / side * 2
    return x, (y + 0.75) / 1.65


def outline(side):
    x, along = places(side)
    inside = np.clip(along, 0, 1)
    half = 0.62 * np.sin(np.pi * inside**0.85) ** 0.9
    half -= 0.09 * abs(inside * 12 % 1 - 0.5) * (half > 0.08)  # teeth
    blade = (abs(x) < half) & (along > 0) & (along < 1)
    stem = (abs(x + 0.1 * along) < 0.04) & (along < 0.03)
    return blade | stem


def main():
    x, along = places(SIDE)
    middle = np.exp(-((x / 0.035) ** 2))
    side = np.exp(-((((abs(x) * 0.9 - along * 1.6) * 4.5 % 1 - 0.5) / 0.13) ** 2)) * (abs(x) > 0.02)
    veins = np.clip(middle + 0.55 * side, 0, 1)[:, :, None]
    colour = np.array([0.30, 0.52, 0.16]) + veins * np.array([0.25, 0.20, 0.14])
    alpha = outline(SIDE * FINE).reshape(SIDE, FINE, SIDE, FINE).mean((1, 3))[:, :, None]
    output = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent / "examples" / "leaf.png"
    Image.fromarray((np.concatenate([colour, alpha], axis=2) * 255).round().astype(np.uint8)).save(output, optimize=True)


if __name__ == "__main__":
    main()
