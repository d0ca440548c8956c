#!/usr/bin/env python3
"""Lays out what scripts/figures made: a contact sheet per figure and the table of times.

Usage: scripts/contact_sheets.py DIR [--times] [--docs]

  --times  only the table
  --docs   also replaces the pictures and the table in docs/

DIR holds a folder per scene with render.png, hologram.png, view.png, view_2.png, wide.png and report.json, and the
reports synthesis_N.json and simulation_N.json of repeated measurements.
"""
import dataclasses
import json
import os
import pathlib
import platform
import re
import subprocess
import sys

import numpy as np
from PIL import Image, ImageDraw, ImageFont

ROOT = pathlib.Path(__file__).resolve().parent.parent
PANEL = (720, 405)  # one picture of a sheet: the sensor's 15.36 × 8.64 mm
GAP = 12
WIDE = (2 * PANEL[0] + GAP, (2 * PANEL[0] + GAP) // 4)  # 56 × 14 mm
INK, FAINT, PAPER = (25, 25, 25), (100, 100, 100), (255, 255, 255)


@dataclasses.dataclass
class Scene:
    name: str
    title: str


@dataclasses.dataclass
class Figure:
    name: str
    title: str
    caption: str
    scenes: list


FIGURES = [
    Figure("fig06", "Fig. 6  Wireframe cube",
           "Edges are sharp at the camera's distance and blurred elsewhere: by propagation, without a lens.",
           [Scene("fig06_wireframe_cube", "")]),
    Figure("fig07", "Fig. 7  Wireframe sphere",
           "First the front is sharp and the back blurred, then the opposite.",
           [Scene("fig07_wireframe_sphere", "")]),
    Figure("fig08", "Fig. 8  Quad tilted about its main diagonal",
           "The diagonal is sharp at 300 mm, the upper right corner at 296.8 mm. "
           "256 × 256 points interfere: fringes or speckle.",
           [Scene("fig08_quad_16", "16 × 16 points"), Scene("fig08_quad_256", "256 × 256 points in phase"),
            Scene("fig08_quad_256_diffuse", "256 × 256 points of random phase")]),
    Figure("fig09", "Fig. 9  Textured quad of 128 × 128 points",
           "Coarse bars, text and greys are reproduced; the finest bars are as fine as the points. "
           "Speckle lowers the contrast.",
           [Scene("fig09_textured_quad", "")]),
    Figure("fig10", "Fig. 10  A chess game by path tracing",
           "White's side is sharp at the first depth, Black's at the second. Twice the samples per side: "
           "dots become surfaces. A game wider than 23.8 mm overlaps with its replicas.",
           [Scene("fig10_chess_256", "256 × 256 first hits"), Scene("fig10_chess_512", "512 × 512 first hits"),
            Scene("fig10_chess_overlap", "1344 × 1344 first hits, 2.7 times as large; cameras of 40 × 22.5 mm see 3 orders")]),
]


def font(size, bold=False):
    return ImageFont.truetype("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf", size)


def load_linear(path):
    """Rows × columns × 3 of linear light from an sRGB file of 8 bits, or a grey one of 16."""
    picture = Image.open(path)
    if picture.mode.startswith("I"):
        code = np.repeat(np.asarray(picture, dtype=np.float32)[:, :, None] / 65535, 3, axis=2)
    else:
        code = np.asarray(picture.convert("RGB"), dtype=np.float32) / 255
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


def shrink(linear, size):
    """Averages light over the sheet's larger pixels, as a coarser sensor does."""
    channels = [Image.fromarray(linear[:, :, c]).resize(size, Image.Resampling.BOX) for c in range(3)]
    return np.stack([np.asarray(c) for c in channels], axis=2)


def develop(linear, white):
    """An sRGB picture in which that light is white."""
    light = np.clip(linear / white, 0, 1)
    code = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return Image.fromarray((255 * code + 0.5).astype(np.uint8))


def white_of(pictures):
    """One exposure for pictures to be compared: nearly all of their light is below white."""
    return max(max(np.percentile(p, 99.7) for p in pictures), 1e-6)


def thicken(linear):
    """Makes luminous points, drawn one pixel wide, visible: the mean of 3 × 3 pixels, applied twice."""
    rows, columns = linear.shape[:2]
    for _ in range(2):
        padded = np.pad(linear, ((1, 1), (1, 1), (0, 0)))
        linear = sum(padded[j : j + rows, i : i + columns] for j in range(3) for i in range(3)) / 9
    return linear


def picture(path, size, is_points=False):
    linear = shrink(load_linear(path), size)
    if is_points:
        linear = thicken(linear)
    return develop(linear, white_of([linear]))


def views(folder, size):
    shrunk = [shrink(load_linear(folder / name), size) for name in ("view.png", "view_2.png")]
    return [develop(v, white_of(shrunk)) for v in shrunk]


def hologram_crop(folder, size):
    hologram = Image.open(folder / "hologram.png").convert("L")
    left, top = (hologram.width - size[0]) // 2, (hologram.height - size[1]) // 2
    return hologram.crop((left, top, left + size[0], top + size[1])).convert("RGB")


def stages(folder):
    return json.loads((folder / "report.json").read_text())["stages"]


def distances(folder):
    return [s["stage"].removeprefix("look at ") for s in stages(folder) if s["stage"].startswith("look at ")]


def scene_rows(folder):
    """The pictures of one scene: (label, picture) by rows."""
    near, far = distances(folder)
    first, second = views(folder, PANEL)
    is_points = "chess" not in folder.name
    return [
        [("scene: luminous points" if is_points else "scene, path-traced",
          picture(folder / "render.png", PANEL, is_points)),
         (f"hologram: the phase on the middle {PANEL[0]} × {PANEL[1]} pixels", hologram_crop(folder, PANEL))],
        [(f"camera at {near}", first), (f"camera at {far}", second)],
        [("camera at 300 mm, sensor 56 × 14 mm: the image and its replicas, orders −1 and 1, 23.8 mm apart",
          picture(folder / "wide.png", WIDE))],
    ]


def make_sheet(figure, output):
    label_height, header = 30, 96
    blocks = [(scene.title, scene_rows(output / scene.name)) for scene in figure.scenes]
    height = header + GAP
    for title, rows in blocks:
        height += (44 if title else 0) + sum(row[0][1].height + label_height + GAP for row in rows)
    sheet = Image.new("RGB", (WIDE[0] + 2 * GAP, height), PAPER)
    draw = ImageDraw.Draw(sheet)
    draw.text((GAP, 12), figure.title, INK, font(34, bold=True))
    draw.text((GAP, 60), figure.caption, FAINT, font(20))
    y = header
    for title, rows in blocks:
        if title:
            draw.text((GAP, y + 6), title, INK, font(26, bold=True))
            y += 44
        for row in rows:
            x = GAP
            for label, image in row:
                draw.text((x, y + 4), label, INK, font(18))
                sheet.paste(image, (x, y + label_height))
                x += image.width + GAP
            y += row[0][1].height + label_height + GAP
    return sheet


def least_seconds(folder, name):
    """The quickest of the measurements: the others had to share the processor."""
    return min(sum(s["seconds"] for s in json.loads(report.read_text())["stages"]) for report in folder.glob(f"{name}_*.json"))


def make_table(output):
    """Waves and milliseconds. Simulation is one view: show, and look at one depth."""
    lines = ["| scene | waves | synthesis (ms) | simulation (ms) |", "|---|---:|---:|---:|"]
    for figure in FIGURES:
        for scene in figure.scenes:
            folder = output / scene.name
            waves = next(s["waves"] for s in stages(folder) if s["stage"] == "trace")
            title = figure.title.replace("  ", ", ", 1) + (f", {scene.title}" if scene.title else "")
            lines.append(f"| {title} | {waves:,} | {1e3 * least_seconds(folder, 'synthesis'):,.0f} "
                         f"| {1e3 * least_seconds(folder, 'simulation'):,.0f} |")
    return "\n".join(lines) + "\n"


def origin():
    """The commit and the processor that a table comes from."""
    def git(*arguments):
        return subprocess.run(["git", "-C", str(ROOT), *arguments], capture_output=True, text=True, check=True).stdout.strip()

    commit = git("rev-parse", "--short=8", "HEAD")
    if git("status", "--porcelain", "--", ".", ":!docs"):  # but for pictures and tables that are being renewed
        commit += " with changes"
    names = re.findall(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.M)
    processor = " ".join(names[0].split()) if names else platform.machine()
    return f"\nCommit {commit}, {os.cpu_count()} cores of {processor}; `scripts/figures --docs` measures it again.\n"


def renew_table(name, table):
    """Puts a table between its marks on the page of figures, with its origin."""
    page = ROOT / "docs" / "explanation" / "figures.md"
    before, _, rest = page.read_text().partition(f"<!-- {name} -->\n")
    _, _, after = rest.partition(f"<!-- /{name} -->\n")
    page.write_text(f"{before}<!-- {name} -->\n{table}{origin()}<!-- /{name} -->\n{after}")


def save_table(output, name, table):
    (output / f"{name}.md").write_text(table)
    print(f"wrote {output}/{name}.md\n\n{table}", end="")


def renew_picture(name, sheet, width=1200, quality=75):
    sheet.resize((width, sheet.height * width // sheet.width), Image.Resampling.LANCZOS).save(
        ROOT / "docs" / "images" / f"{name}.jpg", quality=quality, optimize=True)


def main():
    output = pathlib.Path(sys.argv[1])
    is_for_docs = "--docs" in sys.argv[2:]
    for figure in [] if "--times" in sys.argv[2:] else FIGURES:
        sheet = make_sheet(figure, output)
        sheet.save(output / f"{figure.name}.png")
        print(f"wrote {output / figure.name}.png", flush=True)
        if is_for_docs:
            renew_picture(figure.name, sheet)
    table = make_table(output)
    save_table(output, "table1", table)
    if is_for_docs:
        renew_table("table1", table)


if __name__ == "__main__":
    main()
