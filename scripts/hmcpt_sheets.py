#!/usr/bin/env python3
"""Lays out what scripts/figures made of path-traced holograms: seven contact sheets, a table and the README's picture.

Usage: scripts/hmcpt_sheets.py DIR [--docs]

DIR holds the folders chess_glossy, cornell_box, cornell_layers, glass_and_mirror, oblique_mirror, caustics,
chess_frames and parallax.
"""
import pathlib
import sys

import numpy as np
from PIL import Image, ImageDraw

from contact_sheets import (FAINT, GAP, INK, PAPER, ROOT, develop, distances, font, hologram_crop, load_linear,
                            renew_picture, renew_table, save_table, shrink)

FRAMES = (1, 4, 16, 64)
EYES = (-3, 0, 3)


def lay_out(title, caption, rows):
    """A sheet of rows of (label, picture)."""
    label_height, header = 30, 96
    width = max(sum(image.width + GAP for _, image in row) for row in rows) + GAP
    height = header + GAP + sum(row[0][1].height + label_height + GAP for row in rows)
    sheet = Image.new("RGB", (width, height), PAPER)
    draw = ImageDraw.Draw(sheet)
    draw.text((GAP, 12), title, INK, font(34, bold=True))
    draw.text((GAP, 60), caption, FAINT, font(20))
    y = header
    for row in rows:
        x = GAP
        for label, image in row:
            draw.text((x, y + 4), label, INK, font(18))
            sheet.paste(image, (x, y + label_height))
            x += image.width + GAP
        y += row[0][1].height + label_height + GAP
    return sheet


def developed(path, size, channel=None, percentile=99.7):
    """One picture; channel: only this channel, of a render beside a view in one colour."""
    linear = shrink(load_linear(path), size)
    if channel is not None:
        linear = np.repeat(linear[:, :, channel : channel + 1], 3, axis=2)
    return develop(linear, max(np.percentile(linear, percentile), 1e-6))


def numbered(folder, stem, number):
    return folder / (f"{stem}.png" if number == 1 else f"{stem}_{number}.png")


def colour_sheet(output):
    size, rows = (720, 405), []
    for name in ("chess_glossy", "cornell_box"):
        folder = output / name
        for i, distance in enumerate(distances(folder)[:2], 1):
            rows.append([(f"render, the panel as lens, focus at {distance}",
                          developed(numbered(folder, "render", i), size, percentile=99.5)),
                         (f"view of the hologram at {distance}",
                          developed(numbered(folder, "view", i), size, percentile=99.5))])
    return lay_out("Three holograms, three colours", "A lacquered chess game before a mirror, and a Cornell box: one "
                   "hologram for each of 638, 532 and 450 nm.", rows)


def layers_sheet(output):
    size, folder = (720, 405), output / "cornell_layers"
    names = ["EL: the lamp", "E(D|G)L: direct light", "E(D|G).+L: indirect light", "ES.*L: what the glass shows"]
    layers = [(name, developed(folder / f"view_of_{i}.png", size, percentile=99.5)) for i, name in enumerate(names, 1)]
    return lay_out("A hologram for each light path expression", "The Cornell box at 532 nm, each picture "
                   "with its own exposure. Together they are all light.",
                   [layers[:2], layers[2:],
                    [("all four, shown one after the other", developed(folder / "view.png", size, percentile=99.5)),
                     ("render of all light", developed(folder / "render.png", size, channel=1, percentile=99.5))]])


def focus_sheet(output):
    size, folder = (720, 405), output / "glass_and_mirror"
    sharp = ["the letter", "the chart behind the slab of glass", "the chart beside it", "the letter in the mirror"]
    rows = [[(f"render, the panel as lens, focus at {d}", developed(numbered(folder, "render", i), size, channel=1)),
             (f"view of the hologram at {d}: {what}", developed(numbered(folder, "view", i), size))]
            for i, (d, what) in enumerate(zip(distances(folder), sharp), 1)]
    return lay_out("Focus: images stand at their optical depth", "Letter at 294 mm, mirror at 304 mm, chart at 310 mm, "
                   "its upper half behind 8 mm of glass. One hologram, four distances.", rows)


def astigmatism_sheet(output):
    size, folder = (720, 405), output / "oblique_mirror"
    sharp = ["the level bars", "the upright bars"]
    rows = [[(f"render, the panel as lens, focus at {d}", developed(numbered(folder, "render", i), size, channel=1)),
             (f"view of the holograms at {d}: {what}", developed(numbered(folder, "view", i), size))]
            for i, (d, what) in enumerate(zip(distances(folder), sharp), 1)]
    return lay_out("Astigmatism: a concave mirror at 30°", "A window with bars 30 mm from a mirror of f = 50 mm. Its waves have two "
                   "focal lines.", rows)


def caustics_sheet(output):
    size, folder = (720, 405), output / "caustics"
    return lay_out("Caustics of a small lamp", "A glass ball and a ring of polished metal in the light of a point.",
                   [[("render, the panel as lens", developed(folder / "render.png", size, channel=1)),
                     ("view of the hologram at 300 mm", developed(folder / "view.png", size))]])


def parallax_sheet(output):
    size, folder = (474, 474), output / "parallax"
    names = {-3: "eye at the left, x = −3 mm", 0: "eye in the middle", 3: "eye at the right, x = 3 mm"}
    return lay_out("Parallax: an eye that moves across the panel", "Posts at 143 mm hide other parts of the chart at "
                   "158 mm; the ball's highlights move. Pupil 2 mm.",
                   [[(f"hologram, {names[e]}", developed(folder / f"view_from_{e}.png", size)) for e in EYES],
                    [(f"render, {names[e]}", developed(folder / f"render_from_{e}.png", size)) for e in EYES]])


def flat_places(render):
    """Where the picture is bright and, in a window of 7 × 7 pixels, uniform to 15 %."""
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(render, 3, mode="edge"), (7, 7))
    most, least = windows.max(axis=(2, 3)), windows.min(axis=(2, 3))
    return (render > 0.25 * np.percentile(render, 99.5)) & (most - least < 0.15 * most)


def psnr_of(view, render):
    """PSNR of the view, scaled to the render's mean, against the render, whose largest value is the peak."""
    scale = render.mean() / view.mean()
    return 10 * np.log10(render.max() ** 2 / np.mean((scale * view - render) ** 2))


def frames_table(folder):
    """Contrast of the view over the render in its uniform places, and PSNR there and of the whole picture."""
    render = load_linear(folder / "render.png")[:, :, 0]
    flat = flat_places(render)
    lines = ["| holograms M | speckle contrast | that of one, over √M | PSNR, flat places (dB) "
             "| that of one + 10·log₁₀M | PSNR, whole picture (dB) |", "|---:|---:|---:|---:|---:|---:|"]
    first = None
    for count in FRAMES:
        view = load_linear(folder / f"view_of_{count}.png")[:, :, 0]
        ratio = view[flat] / render[flat]
        contrast, psnr = ratio.std() / ratio.mean(), psnr_of(view[flat], render[flat])
        first = first or (contrast, psnr)
        lines.append(f"| {count} | {contrast:.3f} | {first[0] / count**0.5:.3f} | {psnr:.1f} "
                     f"| {first[1] + 10 * np.log10(count):.1f} | {psnr_of(view, render):.1f} |")
    return "\n".join(lines) + "\n"


def frames_sheet(output):
    size, folder = (720, 405), output / "chess_frames"
    views = [(f"mean of {m} holograms" if m > 1 else "one hologram",
              developed(folder / f"view_of_{m}.png", size, percentile=99.0)) for m in FRAMES]
    return lay_out("Time multiplexing: the mean of M holograms", "The same waves with other random phases: speckle "
                   "falls as 1/√M.", [views[:2], views[2:],
                                      [("render, the panel as lens", developed(folder / "render.png", size, channel=0))]])


def readme_picture(output):
    size, folder = (488, 275), output / "chess_glossy"
    distance = distances(folder)[1]
    pictures = [("3D scene, path-traced", developed(folder / "render_2.png", size, percentile=99.5)),
                ("hologram for 638 nm (detail)", hologram_crop(folder, size)),
                (f"what a camera sees at {distance}", developed(folder / "view_2.png", size, percentile=99.5))]
    strip = Image.new("RGB", (3 * size[0] + 2 * GAP, size[1] + 28), PAPER)
    draw = ImageDraw.Draw(strip)
    for i, (label, image) in enumerate(pictures):
        draw.text((i * (size[0] + GAP), 2), label, INK, font(18))
        strip.paste(image, (i * (size[0] + GAP), 28))
    return strip


def save_sheets(output, sheets):
    for name, sheet in sheets.items():
        sheet.save(output / f"{name}.png")
        print(f"wrote {output / name}.png", flush=True)


def renew_docs(output, sheets, table):
    for name, sheet in sheets.items():
        renew_picture(name, sheet)
    Image.open(output / "chess_colour.png").save(ROOT / "docs" / "images" / "chess_colour.jpg", quality=88, optimize=True)
    renew_table("frames", table)


def main():
    output = pathlib.Path(sys.argv[1])
    sheets = {"hmcpt_colour": colour_sheet(output), "hmcpt_layers": layers_sheet(output),
              "hmcpt_focus": focus_sheet(output), "hmcpt_astigmatism": astigmatism_sheet(output),
              "hmcpt_caustics": caustics_sheet(output), "hmcpt_parallax": parallax_sheet(output),
              "hmcpt_frames": frames_sheet(output)}
    save_sheets(output, sheets)
    readme_picture(output).save(output / "chess_colour.png", optimize=True)
    table = frames_table(output / "chess_frames")
    save_table(output, "frames", table)
    if "--docs" in sys.argv[2:]:
        renew_docs(output, sheets, table)


if __name__ == "__main__":
    main()
