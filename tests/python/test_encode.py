"""encode, compare and calibrate, as the program's files."""

import json

import numpy as np
import pytest

import holotrace as ht
from test_waves import equal


@pytest.fixture
def waves(points):
    return ht.synthesize(points, ht.Slm(columns=64, rows=48, pitch=8e-6))


@pytest.mark.parametrize(
    "method, more",
    [("phase", {}), ("amplitude", {}), ("off-axis", {}), ("double-phase", {}), ("error-diffusion", {}), ("binary", {}),
     ("gerchberg-saxton", {"target_distances": 0.1, "iterations": 3}),
     ("sgd", {"target_distances": "90, 100 mm", "iterations": 3, "seed": 4})],
)
def test_encode_is_the_program_bit_by_bit(waves, method, more, tmp_path, program):
    waves.save(tmp_path / "f.npy")
    flags = []
    for name, value in more.items():
        flags += ["--" + name.replace("_", "-"), f"{value} m" if isinstance(value, float) else value]
    program("encode", "f.npy", "--method", method, *flags, "-o", "h.png")
    hologram = ht.encode(waves, method=method, **more)
    hologram.save(tmp_path / "own.png")
    assert (tmp_path / "own.png").read_bytes() == (tmp_path / "h.png").read_bytes()
    assert equal(hologram.level, ht.load_hologram(tmp_path / "h.png").level)


def test_register_is_the_program(tmp_path, program):
    """A picture moved by 3 and 2 pixels; the figures of both are the same to the last digit."""
    blobs = np.zeros((96, 128))
    for y, x, level in np.random.default_rng(5).uniform((8, 8, 0.2), (88, 120, 1), (40, 3)):
        rows, columns = np.mgrid[0:96, 0:128]
        blobs += level * np.exp(-((rows - y) ** 2 + (columns - x) ** 2) / 8)
    simulation = ht.Image(blobs.astype(np.float32))
    photograph = ht.Image(np.roll(blobs, (2, 3), (0, 1)).astype(np.float32)[:, :, None].repeat(3, 2))
    simulation.save(tmp_path / "s.exr")
    photograph.save(tmp_path / "p.exr")
    stated = json.loads(program("compare", "--register", "p.exr", "s.exr", "-o", "aligned.exr", "--json"))
    aligned, figures = ht.register(photograph, simulation)
    assert equal(aligned.pixels, ht.load_image(tmp_path / "aligned.exr").pixels)
    assert figures["shift_x_pixels"] == pytest.approx(3, abs=0.1)  # the accuracy that docs/how_to states
    assert figures["shift_y_pixels"] == pytest.approx(-2, abs=0.1)  # y up
    for name in ("magnification", "shift_x_pixels", "gain", "overlap", "compared_columns", "ssim", "rms_error"):
        assert figures[name] == stated[name], name


def test_encode_uses_the_panel_that_it_is_given(waves, tmp_path, program):
    (tmp_path / "panel.toml").write_text('columns = 64\nrows = 48\npitch = "8 um"\nlevels = 16\n')
    waves.save(tmp_path / "f.npy")
    program("encode", "f.npy", "--slm", "panel.toml", "-o", "h.png")
    hologram = ht.encode(waves, tmp_path / "panel.toml")
    assert hologram.levels == 16 and hologram.slm.levels == 16 and ht.encode(waves).slm is None
    assert equal(hologram.level, ht.load_hologram(tmp_path / "h.png").level)


def test_encode_of_a_picture_is_the_program_bit_by_bit(tmp_path, program):
    picture = ht.Image(np.random.default_rng(3).uniform(size=(20, 30)).astype(np.float32))
    picture.save(tmp_path / "p.exr")
    (tmp_path / "panel.toml").write_text('columns = 64\nrows = 48\npitch = "8 um"\n')
    program("encode", "p.exr", "--slm", "panel.toml", "--wavelength", "532 nm", "--method", "sgd", "--iterations", 3,
            "--target-distances", "50 mm", "--target-columns", 40, "--target-rows", 32, "--resample", "true",
            "-o", "h.png")
    hologram = ht.encode(picture, tmp_path / "panel.toml", wavelength="532 nm", method="sgd", iterations=3,
                         target_distances=0.05, target_columns=40, target_rows=32, resample=True)
    assert equal(hologram.level, ht.load_hologram(tmp_path / "h.png").level)
    assert hologram.facts["psnr_db"] > 0 and len(hologram.facts["convergence"]) == 4


def test_frames_of_a_focal_stack_are_the_program(tmp_path, program):
    rng = np.random.default_rng(3)
    stack = ht.FocalStack(rng.uniform(size=(2, 48, 64)).astype(np.float32), [0.05, 0.06], "8 um")
    stack.save(tmp_path / "s.h5")
    (tmp_path / "panel.toml").write_text('columns = 64\nrows = 48\npitch = "8 um"\n')
    program("encode", "s.h5", "--slm", "panel.toml", "--wavelength", "532 nm", "--method", "sgd", "--iterations", 2,
            "--frames", 2, "-o", "h.png")
    frames = ht.encode_all(stack, tmp_path / "panel.toml", wavelength="532 nm", method="sgd", iterations=2, frames=2)
    assert [equal(one.level, ht.load_hologram(tmp_path / name).level)
            for one, name in zip(frames, ("h.png", "h_2.png"))] == [True, True]


def test_an_array_with_a_wavelength_is_a_target_picture():
    given = dict(wavelength="532 nm", target_distances="50 mm", method="gerchberg-saxton", iterations=2)
    panel, pixels = ht.Slm("pluto", columns=40, rows=32), np.random.default_rng(5).uniform(size=(32, 40))
    assert equal(ht.encode(pixels, panel, **given).level, ht.encode(ht.Image(pixels), panel, **given).level)


def test_a_path_in_place_of_what_it_holds_is_an_error_that_says_what_reads_it():
    with pytest.raises(ht.Error, match=r"expected a Scene to run, got str; read one with ht.load_scene\(path\)"):
        ht.run("scene.toml")


def test_encode_says_what_is_missing(waves):
    with pytest.raises(ht.Error, match="a picture has no wavelength; give its wavelength"):
        ht.encode(ht.Image(np.ones((4, 4))))
    with pytest.raises(ht.Error, match="expected frames only with a focal stack"):
        ht.encode_all(waves, frames=2)
    with pytest.raises(ht.Error, match="use encode_all"):
        ht.encode(ht.Image(np.ones((8, 8), np.float32)), ht.Slm(columns=8, rows=8, pitch=8e-6),
                  wavelength=["638 nm", "450 nm"], target_distances=0.01, iterations=1)
    with pytest.raises(ht.Error, match="expected a Field to encode, got float"):
        ht.encode([1.0])


@pytest.mark.parametrize(
    "level, levels, message",
    [([[0.5]], 256, "whole numbers"), ([[-1]], 256, "from 0 to 65535, got -1"), ([[70000]], 256, "got 70000"),
     ([[3, 256]], 256, "below 256, got 256 at row 0, column 1"), ([1, 2], 256, "shape"), ([[0]], 1, '"levels"')],
)
def test_bad_levels_are_refused(level, levels, message):
    with pytest.raises(ht.Error, match=message):
        ht.Hologram(level, "8 um", "532 nm", levels=levels)


def test_phases_become_the_nearest_levels():
    hologram = ht.Hologram.from_phase([[0, np.pi, -np.pi / 2, 2 * np.pi - 1e-9]], "8 um", "532 nm", levels=8)
    assert hologram.level.tolist() == [[0, 4, 6, 0]]
    assert hologram.phase.tolist() == [[0, np.pi, 1.5 * np.pi, 0]]


def test_compare_has_the_figures_of_the_program(tmp_path, program):
    rng = np.random.default_rng(3)
    a, b = (ht.Image(rng.uniform(0.1, 1, (30, 40)).astype(np.float32)) for _ in range(2))
    a.save(tmp_path / "a.exr"), b.save(tmp_path / "b.exr")
    written = json.loads(program("compare", "a.exr", "b.exr", "--json"))
    own = ht.compare(a, b)
    for name, value in own.items():
        assert value == written[name + "_db" if name.startswith("psnr") else name]


def test_compare_takes_the_luminance_beside_a_grey_picture():
    grey = np.random.default_rng(1).random((12, 16)).astype(np.float32)
    colour = np.stack([grey, 0.5 * grey, 2 * grey], axis=-1)  # luminance: 0.2126 + 0.5 · 0.7152 + 2 · 0.0722 of it
    figures = ht.compare(ht.Image(colour), ht.Image(grey))
    assert figures["scale"] == pytest.approx(0.2126 + 0.3576 + 0.1444, rel=1e-6) and figures["ssim"] == pytest.approx(1)


def test_view_takes_a_run():
    scene = ht.Scene(wavelength="532 nm", slm={"columns": 32, "rows": 24}, camera={"distances": "100 mm"},
                     object=[{"type": "points", "points": [[0, 0, -0.1]]}])
    run = ht.run(scene)
    assert np.array_equal(np.asarray(ht.view(run)), np.asarray(ht.view(run.holograms)))


def test_compare_of_fields_is_the_norm_of_their_difference(waves):
    other = ht.Field(2j * waves.samples, waves.pitch, waves.wavelength)
    figures = ht.compare(waves, other)
    assert figures["relative_error"] == pytest.approx(abs(2j - 1), rel=1e-6)
    assert figures["scale"] == pytest.approx(1 / 2j, rel=1e-6) and figures["scaled_error"] < 1e-6


def test_calibration_patterns_are_the_program_bit_by_bit(tmp_path, program):
    (tmp_path / "panel.toml").write_text('columns = 400\nrows = 300\npitch = "8 um"\n')
    program("calibrate", "patterns", "--slm", "panel.toml", "--distance", "50 mm", "--level-patterns", 1, "-o", "plan")
    plan = ht.calibration_patterns(tmp_path / "panel.toml", distance="50 mm", level_patterns=1)
    written = ht.load_calibration_plan(tmp_path / "plan" / "calibration.toml")
    assert plan.names == written.names
    assert all(equal(a.level, b.level) for a, b in zip(plan.holograms, written.holograms))


def test_calibrate_refuses_photographs_that_are_missing():
    plan = ht.calibration_patterns(ht.Slm(columns=400, rows=300, pitch=8e-6), distance="50 mm", level_patterns=1)
    with pytest.raises(ht.Error, match="photograph"):
        ht.calibrate(plan, [])


@pytest.mark.parametrize("method", ["sgd", "gerchberg-saxton", "weighted-gerchberg-saxton"])
def test_encode_on_a_device_is_the_program_bit_by_bit(method, waves, tmp_path, program):
    if len(json.loads(program("info", "--devices", "--json"))["devices"]) < 2:
        pytest.skip("no OpenCL device here")
    waves.save(tmp_path / "f.npy")
    flags = ["--method", method, "--target-distances", "90 mm", "--iterations", 3, "--device", "opencl"]
    program("encode", "f.npy", *flags, "-o", "h.png")
    hologram = ht.encode(waves, method=method, target_distances="90 mm", iterations=3, device="opencl")
    assert equal(hologram.level, ht.load_hologram(tmp_path / "h.png").level)
    assert "device" in hologram.facts


def test_pictures_for_a_panel_are_the_programs(waves, tmp_path, program):
    """And NumPy's own: mirrored, a quarter turn, and 64 of 256 levels more from pixel to pixel."""
    hologram = ht.encode(waves)
    hologram.save(tmp_path / "h.png")
    hologram.save(tmp_path / "h.npy")
    assert np.array_equal(np.load(tmp_path / "h.npy"), hologram.level)
    hologram.save(tmp_path / "own.npy", flip="x", turn="90", blaze="32 um")
    program("display", "h.png", "-o", "panel.npy", "--flip", "x", "--turn", "90", "--blaze", "32 um")
    assert (tmp_path / "own.npy").read_bytes() == (tmp_path / "panel.npy").read_bytes()
    blazed = (hologram.level + 64 * (np.arange(64) - 31.5)).astype(int) % 256
    assert np.array_equal(np.load(tmp_path / "own.npy"), np.rot90(blazed[:, ::-1]))
    assert json.loads((tmp_path / "own.npy.json").read_text())["turn"] == "90"
    with pytest.raises(ht.Error, match="got a picture for a panel"):
        ht.load_hologram(tmp_path / "own.npy")
    (tmp_path / "table.lut").write_text("".join(f"{255 - grey}\n" for grey in range(256)))
    paths = ht.save_panel_images([hologram, hologram], tmp_path / "two.npy", lut=tmp_path / "table.lut")
    assert [len(paths), paths[1][-9:]] == [2, "two_2.npy"]
    assert np.array_equal(np.load(paths[1]), 255 - hologram.level)
    with pytest.raises(ht.Error, match="unknown parameter \"flop\""):
        hologram.save(tmp_path / "own.npy", flop="x")


def test_tables_of_the_maker_are_of_the_panels_pixels(waves, tmp_path, program):
    """Turned first; then the flatness map, modulo a cycle; then the level table. By the program, and by NumPy."""
    hologram = ht.encode(waves)
    hologram.save(tmp_path / "h.png")
    flatness = np.random.default_rng(2).integers(0, 256, (64, 48)).astype(np.uint8)  # of the turned panel
    np.save(tmp_path / "flatness.npy", flatness * (2 * np.pi / 256))
    table = np.random.default_rng(3).permutation(256)
    (tmp_path / "table.lut").write_text("".join(f"{grey} {value}\n" for grey, value in enumerate(table)))
    program("display", "h.png", "-o", "panel.npy", "--turn", "90", "--correction", "flatness.npy", "--lut", "table.lut")
    expected = table[(np.rot90(hologram.level).astype(int) + flatness) % 256]
    assert np.array_equal(np.load(tmp_path / "panel.npy"), expected)
    hologram.save(tmp_path / "own.npy", turn=90, correction=tmp_path / "flatness.npy", lut=tmp_path / "table.lut")
    assert (tmp_path / "own.npy").read_bytes() == (tmp_path / "panel.npy").read_bytes()
    assert (tmp_path / "own.npy.json").read_bytes() == (tmp_path / "panel.npy.json").read_bytes()


def test_holograms_of_other_programs_are_read(tmp_path):
    phases = np.linspace(-7, 7, 12, dtype=np.float64).reshape(3, 4)
    np.save(tmp_path / "phases.npy", phases)
    hologram = ht.load_hologram(tmp_path / "phases.npy", pitch=8e-6, wavelength=633e-9, levels=1024)
    assert np.array_equal(hologram.level, np.rint(phases / (2 * np.pi) * 1024) % 1024)
    np.savetxt(tmp_path / "levels.csv", [[0, 1], [2, 3]], fmt="%d", delimiter=",")
    levels = ht.load_hologram(tmp_path / "levels.csv", pitch=8e-6, wavelength=633e-9, levels=4, modulation="amplitude")
    assert levels.modulation == "amplitude" and np.array_equal(levels.level, [[0, 1], [2, 3]])


# A picture that rests needs no more than the least number of iterations, and does not lose by them: 0.1 dB is less than what a
# single update moves it.
def test_next_picture_goes_on_from_the_last_hologram():
    slm = ht.Slm("pluto", columns=96, rows=64)
    phases = np.random.default_rng(1).random((64, 96))
    field = ht.Field(np.exp(1j * phases).astype("c8"), pitch=8e-6, wavelength=532e-9)
    params = {"method": "sgd", "iterations": 20, "target_distances": [0.01], "progress": False}
    still = ht.encode(field, slm, **params)
    following = ht.encode(field, slm, last=still, **params)
    assert following.facts["iterations"] == 4  # a fifth
    assert following.facts["start"] == "last"
    assert following.facts["psnr_db"] > still.facts["psnr_db"] - 0.1
    with pytest.raises(ht.Error, match='expected the method sgd for a start from the last holograms, got "phase"'):
        ht.encode(field, slm, last=still, progress=False)
