#!/usr/bin/env python3
"""Lays out what scripts/figures made of the virtual SLM: sheets of encoders, of effects and of stereo, and a table.

Usage: scripts/panel_sheets.py DIR [--docs]

DIR holds the folders encoders, effects, polariser and stereo.
"""
import json
import pathlib
import shutil
import sys

import numpy as np
from PIL import Image

from contact_sheets import ROOT, develop, load_linear, renew_picture, renew_table, save_table, shrink
from hmcpt_sheets import developed, lay_out, save_sheets

ENCODERS = {"phase": "phase alone", "double-phase": "double phase", "error-diffusion": "error diffusion",
            "gerchberg-saxton": "Gerchberg–Saxton, random start",
            "weighted-gerchberg-saxton": "weighted Gerchberg–Saxton", "binary": "binary phase, off-axis", "sgd": "sgd",
            "complex": "complex field (complex panel)"}
EFFECTS = {"ideal": "sgd on an ideal panel", "unknown": "the same levels, all effects on",
           "known": "sgd that knows the panel"}
POLARISERS = {"p0": "polariser along the director", "p10": "at 10°", "p20": "at 20°", "p20a": "at 20°, with an analyser"}
PICTURE = (640, 352)


def detail(path, size):
    """The middle of a hologram, one picture pixel per panel pixel."""
    picture = Image.open(path)
    if picture.mode.startswith("I"):  # more than 256 levels
        picture = Image.fromarray((np.asarray(picture) >> 8).astype(np.uint8))
    picture = picture.convert("RGB")
    left, top = (picture.width - size[0]) // 2, (picture.height - size[1]) // 2
    return picture.crop((left, top, left + size[0], top + size[1]))


def metrics(folder, name):
    return json.loads((folder / f"{name}.json").read_text())


def encoders_sheet(folder):
    rows = [[("target", developed(folder / "target.png", PICTURE, channel=0, percentile=99.9)),
             ("convergence", Image.open(folder / "sgd_convergence.png").convert("RGB").resize(PICTURE))]]
    for name, title in ENCODERS.items():
        psnr = metrics(folder, name)["psnr_amplitude_db"]
        rows.append([(f"{title}: view, {psnr:.1f} dB",
                      developed(folder / f"{name}_view.png", PICTURE, percentile=99.7)),
                     ("its levels (detail)", detail(folder / f"{name}.png", PICTURE))])
    return lay_out("Encoders: levels for the same picture", "1600 × 880 pixels within a panel of 1920 × 1080, 8 µm, 8 bit; "
                   "200 mm away at 520 nm.", rows)


def encoders_table(folder):
    lines = ["| encoder | PSNR of moduli (dB) | SSIM |", "|---|---:|---:|"]
    for name, title in ENCODERS.items():
        found = metrics(folder, name)
        lines.append(f"| {title} | {found['psnr_amplitude_db']:.1f} | {found['ssim']:.3f} |")
    return "\n".join(lines) + "\n"


def effects_sheet(folder):
    row = [(f"{title}: {metrics(folder, name)['psnr_amplitude_db']:.1f} dB",
            developed(folder / f"{name}_view.png", PICTURE, percentile=99.7)) for name, title in EFFECTS.items()]
    return lay_out("A real panel", "All effects of `pluto`: calibration, crosstalk, light from the gaps, flicker, curvature.",
                   [row])


def polariser_sheet(folder):
    linear = {name: shrink(load_linear(folder / f"{name}.png"), (480, 480)) for name in POLARISERS}
    white = np.percentile(linear["p0"], 99.7)  # the same for all
    return lay_out("A polariser that is turned", "Angles are from the director of the crystal. Light that it does not delay is a haze.",
                   [[(POLARISERS[name], develop(linear[name], white)) for name in row] for row in (("p0", "p10"), ("p20", "p20a"))])


def stereo_sheet(folder):
    size = (420, 420)
    return lay_out("Stereo pair and hologram: two eyes on the panel", "Above: two renders, as a stereoscopic display would "
                   "show. Below: what the same eyes see of one hologram.",
                   [[(f"{kind}, {which}", developed(folder / f"{stem}_{eye}.png", size))
                     for eye, which in (("left", "left eye"), ("right", "right eye"))] +
                    [(f"{kind}, anaglyph", Image.open(folder / f"{stem}_anaglyph.png").convert("RGB").resize(size))]
                    for kind, stem in (("render", "stereo"), ("hologram", "holo"))])


def renew_docs(output, sheets, table):
    for name, sheet in sheets.items():
        renew_picture(name, sheet, width=960, quality=65)
    for chart in ("limits_volume", "grid_cost", "sharpness"):
        shutil.copy(output / f"{chart}.png", ROOT / "docs" / "images" / f"{chart}.png")
    renew_table("encoders", table)


def main():
    output = pathlib.Path(sys.argv[1])
    sheets = {"panel_encoders": encoders_sheet(output / "encoders"), "panel_effects": effects_sheet(output / "effects"),
              "polariser": polariser_sheet(output / "polariser"), "panel_stereo": stereo_sheet(output / "stereo")}
    save_sheets(output, sheets)
    table = encoders_table(output / "encoders")
    save_table(output, "encoders", table)
    if "--docs" in sys.argv[2:]:
        renew_docs(output, sheets, table)


if __name__ == "__main__":
    main()
