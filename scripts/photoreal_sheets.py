#!/usr/bin/env python3
"""Lays out what scripts/figures made of holograms that were optimised against path-traced light: the series of focus, pupil
and frames beside the renders, and the README's picture; or scenes that show materials.

Usage: scripts/photoreal_sheets.py DIR [--only materials] [--docs]

DIR holds the folders chess_photoreal, chess_light_field and photoreal_frames_1, _2, _4 and _8; or those of MATERIALS.
"""
import pathlib
import sys

import numpy as np
from PIL import Image

from contact_sheets import (ROOT, develop, distances, load_linear, renew_picture, renew_table, save_table, shrink,
                            stages)
from hmcpt_sheets import lay_out, numbered, save_sheets

FRAMES = (1, 2, 4, 8)
EYES = {"-1.5": "x = −1.5 mm", "0": "x = 0", "1.5": "x = 1.5 mm"}
SIZE = (480, 270)
MATERIALS = {
    "light_shafts": ("Fog, milk and skin", "A lamp shines through a grille into fog. Waves start at its particles, and inside of the milk (left) and the skin."),
    "leaves": ("Leaves", "Squares with a picture whose alpha cuts out the leaf. Light shines through them; their shadows fall on the wall."),
    "prism": ("A prism", "A beam over a table, parted by dense flint glass; each colour is bent by its own index."),
    "snow": ("Snow", "Low sunlight enters the snowman and comes out elsewhere; firs stand behind it."),
    "candle": ("Fire", "A flame of glowing soot lights wax, a glass ball before it and a wall behind it."),
    "layered_surfaces": ("Layered surfaces", "Above: clear coat, velvet, brushed metal, thin film. Below: glass that absorbs, glass clear in half, a soap bubble, paper."),
    "sunset_optimised": ("A low sun", "The sky and its sun are infinitely far away: they are blurred where the view is sharp on the gate, then on the ball."),
}


def alike(paths, size, is_grey=False):
    """Pictures that are exposed by the same rule: the 99th percentile of each is white."""
    pictures = []
    for path in paths:
        linear = shrink(load_linear(path), size)
        if is_grey:
            linear = np.repeat(linear[:, :, :1], 3, axis=2)
        pictures.append(develop(linear, max(np.percentile(linear, 99), 1e-6)))
    return pictures


def beside_renders(labels, views, renders, size=SIZE, is_grey=True):
    """Two rows: the views, and below them the renders; grey: of the light in red."""
    return [list(zip([f"hologram, {label}" for label in labels], alike(views, size, is_grey))),
            list(zip([f"render, {label.partition(' (')[0]}" for label in labels], alike(renders, size, is_grey)))]


def psnr_at(folder, distance):
    return next(s["psnr_db"] for s in stages(folder) if s["stage"] == f"look at {distance}")


def focus_sheet(output):
    folder = output / "photoreal_frames_8"
    planes = distances(folder)
    labels = [f"focus at {d} ({psnr_at(folder, d):.1f} dB)" for d in planes]
    numbers = range(1, len(planes) + 1)
    return lay_out("Focus", "Eight holograms found together, seen through the whole panel; the render has the panel as its lens.",
                   beside_renders(labels, [numbered(folder, "view", i) for i in numbers],
                                  [numbered(folder, "render", i) for i in numbers]))


def pupil_sheet(output):
    folder = output / "chess_light_field"
    return lay_out("Pupil", "Eight holograms for target = \"light-field\", seen through a pupil of 4 mm, 100 mm in front of the "
                   "panel, focused on White's king.",
                   beside_renders([f"eye at {name}" for name in EYES.values()],
                                  [folder / f"view_from_{eye}.png" for eye in EYES],
                                  [folder / f"render_from_{eye}.png" for eye in EYES]))


def material_sheet(output, name):
    folder, (title, caption) = output / name, MATERIALS[name]
    planes = distances(folder)[:2]
    labels = [f"focus at {d} ({psnr_at(folder, d):.1f} dB)" for d in planes]
    with Image.open(folder / "view.png") as view:
        size, is_grey = (720, round(720 * view.height / view.width)), view.mode != "RGB"
    pictures = [[numbered(folder, stem, i + 1) for i in range(len(planes))] for stem in ("view", "render")]
    return lay_out(title, caption, beside_renders(labels, *pictures, size, is_grey))


def frames_sheet(output):
    folders = [output / f"photoreal_frames_{count}" for count in FRAMES]
    size = (720, 405)
    views = alike([folder / "view_2.png" for folder in folders], size, True)
    pictures = [(f"{count} frame{'s' if count > 1 else ''} ({psnr_at(folder, '300 mm'):.1f} dB)", view)
                for count, folder, view in zip(FRAMES, folders, views)]
    render = alike([folders[0] / "render_2.png"], size, True)[0]
    return lay_out("Frames", "Holograms found together for target = \"render\", focused at 300 mm, and the render.",
                   [pictures[:2], pictures[2:], [("render, the panel as lens", render)]])


def frames_table(output):
    """What the report of each run says of its view."""
    lines = ["| frames | PSNR (dB) | SSIM | speckle contrast |", "|---:|---:|---:|---:|"]
    for count in FRAMES:
        folder = output / f"photoreal_frames_{count}"
        view = next(s for s in stages(folder) if s["stage"] == "look at 300 mm")
        lines.append(f"| {count} | {view['psnr_db']:.1f} | {view['ssim']:.3f} | {view['speckle_contrast']:.3f} |")
    return "\n".join(lines) + "\n"


def readme_picture(output):
    """Views above, renders below, focused on the white and on the black king."""
    folder, (width, height), gap = output / "chess_photoreal", (800, 450), 8
    sheet = Image.new("RGB", (2 * width + gap, 2 * height + gap), "white")
    for row, stem in enumerate(("view", "render")):
        pictures = alike([numbered(folder, stem, i) for i in (1, 2)], (width, height))
        for column, picture in enumerate(pictures):
            sheet.paste(picture, (column * (width + gap), row * (height + gap)))
    return sheet


def main():
    output, docs = pathlib.Path(sys.argv[1]), "--docs" in sys.argv[2:]
    if "materials" in sys.argv[2:]:
        sheets = {name: material_sheet(output, name) for name in MATERIALS}
        save_sheets(output, sheets)
        for name, sheet in sheets.items() if docs else ():
            renew_picture(name, sheet)
        return
    sheets = {"photoreal_focus": focus_sheet(output), "photoreal_pupil": pupil_sheet(output),
              "photoreal_frames": frames_sheet(output)}
    save_sheets(output, sheets)
    picture = readme_picture(output)
    picture.save(output / "chess_photoreal.png", optimize=True)
    table = frames_table(output)
    save_table(output, "optimised", table)
    if docs:
        renew_table("optimised", table)
        for name, sheet in sheets.items():
            renew_picture(name, sheet)
        picture.save(ROOT / "docs" / "images" / "chess_photoreal.jpg", quality=88, optimize=True)


if __name__ == "__main__":
    main()
