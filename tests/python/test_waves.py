"""propagate, synthesize, show and expose: the program's files bit by bit, and sums by NumPy."""

import json

import numpy as np
import pytest

import holotrace as ht
from holotrace import _core
from conftest import random_samples


def equal(a, b):
    return a.dtype == b.dtype and a.tobytes() == b.tobytes()


@pytest.mark.parametrize("double", [False, True])
def test_propagate_is_the_program_bit_by_bit(field, tmp_path, program, double):
    flags = ["--double"] if double else []
    given = field.astype(np.complex128 if double else np.complex64)
    given.save(tmp_path / "f.npy")
    program("propagate", "f.npy", "--distance", "20 mm", "--method", "fresnel", "--columns", 40, "--centre-x", "8 um",
            *flags, "-o", "g.npy")
    moved = ht.propagate(given, "20 mm", method="fresnel", columns=40, centre_x=8e-6)
    assert equal(moved.samples, np.load(tmp_path / "g.npy"))
    assert moved.z == ht.load_field(tmp_path / "g.npy").z == 0.02


def test_propagate_keeps_the_name_of_the_light():
    named = ht.Field(np.ones((4, 4)), 8e-6, 532e-9, name="lamp")
    assert ht.propagate(named, 1e-4).name == "lamp"


def test_propagation_is_the_rayleigh_sommerfeld_sum(field):
    """Against the integral itself, summed by NumPy: the double-precision goal of the project is 1e-9."""
    d, p, k = 0.01, field.pitch, 2 * np.pi / field.wavelength
    moved = ht.propagate(field.astype(np.complex128), d, method="rayleigh-sommerfeld")
    x, y = np.meshgrid(field.x, field.y)
    for row, column in ((0, 0), (16, 24), (32, 47)):
        r = np.sqrt((x[row, column] - x) ** 2 + (y[row, column] - y) ** 2 + d**2)
        kernel = d / (2 * np.pi * r**2) * (1 / r - 1j * k) * np.exp(1j * k * r)
        expected = (kernel * np.asarray(field, np.complex128)).sum() * p**2
        assert abs(moved.samples[row, column] - expected) <= 1e-9 * np.abs(moved.samples).max()


def test_there_and_back_is_the_field_itself(field):
    """A periodic field keeps all its light: the inverse is exact to rounding of float, some 1e-7 per transform."""
    back = ht.propagate(ht.propagate(field, 0.01, periodic=True), -0.01, periodic=True)
    assert np.linalg.norm(back.samples - field.samples) <= 2e-6 * np.linalg.norm(field.samples)


def test_synthesize_is_the_program_bit_by_bit(points, tmp_path, program):
    points.save(tmp_path / "s.ply")
    program("field", "s.ply", "--slm", "pluto", "--columns", 64, "--rows", 48, "--method", "exact", "-o", "f.npy")
    panel = ht.Slm("pluto", columns=64, rows=48)
    assert equal(ht.synthesize(points, panel, method="exact").samples, np.load(tmp_path / "f.npy"))


def test_synthesize_on_a_device_is_the_program_bit_by_bit(points, tmp_path, program):
    if len(json.loads(program("info", "--devices", "--json"))["devices"]) < 2:
        pytest.skip("no OpenCL device here")
    points.save(tmp_path / "s.ply")
    size = {"columns": 64, "rows": 48, "pitch": 8e-6}
    program("field", "s.ply", "--columns", 64, "--rows", 48, "--pitch", "8 um", "--device", "opencl", "-o", "f.npy")
    on_device = ht.synthesize(points, ht.Slm(**size), device="opencl")
    assert equal(on_device.samples, np.load(tmp_path / "f.npy"))
    exact = ht.synthesize(points, ht.Slm(**size), method="exact")
    assert np.linalg.norm(on_device.samples - exact.samples) <= 1e-3 * np.linalg.norm(exact.samples)


def test_propagate_on_a_device_is_the_program_bit_by_bit(points, tmp_path, program):
    if len(json.loads(program("info", "--devices", "--json"))["devices"]) < 2:
        pytest.skip("no OpenCL device here")
    field = ht.synthesize(points, ht.Slm(columns=64, rows=48, pitch="8 um"))
    field.save(str(tmp_path / "f.npy"))
    program("propagate", "f.npy", "--distance", "-50 mm", "--device", "opencl", "-o", "g.npy")
    there = ht.propagate(field, "-50 mm", device="opencl")
    assert equal(there.samples, np.load(tmp_path / "g.npy"))
    assert "device" in there.facts
    here = ht.propagate(field, "-50 mm")
    assert np.linalg.norm(there.samples - here.samples) <= 1e-6 * np.linalg.norm(here.samples)
    seen = ht.expose(field, "50 mm", propagate={"device": "opencl"})
    assert "device" in seen.facts
    with pytest.raises(ht.Error, match="in Python: a complex64 array"):
        ht.propagate(ht.Field(here.samples.astype(np.complex128), pitch="8 um", wavelength="532 nm"), "1 mm", device="opencl")


def test_devices_are_checked(points):
    with pytest.raises(ht.Error, match="expected a device: cpu, auto, opencl, opencl:N .* or opencl:all; got \"gpu\""):
        ht.synthesize(points, device="gpu")
    # The core of holotrace.torch and holotrace.jax.
    with pytest.raises(ht.Error, match="expected the device cpu for gradients, got opencl; leave out device"):
        _core.Propagation32(4, 4, "8 um", "532 nm", "1 mm", {"device": "opencl"})
    with pytest.raises(ht.Error, match="for gradients, got auto; leave out device, or use ht.show"):
        _core.Panel(ht.Slm(columns=4, rows=4, pitch=8e-6)._core, "532 nm", {"device": "auto"})


def test_synthesis_is_the_sum_of_spherical_waves(points):
    """U = sum of a d/r exp(ikr + i phase) inside each wave's box; float rounding of the result is 6e-8 of a term."""
    panel = ht.Slm(columns=40, rows=30, pitch=8e-6)
    u = ht.synthesize(points, panel, method="exact")
    x, y = np.meshgrid(u.x, u.y)
    expected = np.zeros(u.shape, complex)
    k = 2 * np.pi / points.wavelength
    for (a, b, c), amplitude, phase in zip(points.positions, points.amplitudes, points.phases):
        r = np.sqrt((x - a) ** 2 + (y - b) ** 2 + c**2)
        radius = -c * np.tan(np.arcsin(points.wavelength / (2 * u.pitch)))
        inside = (abs(x - a) <= radius) & (abs(y - b) <= radius)
        expected += inside * amplitude * (-c / r) * np.exp(1j * (k * r + phase))
    assert np.abs(u.samples - expected).max() <= 20 * 1.2e-7  # 20 waves of at most 1


def test_show_and_expose_are_the_program_bit_by_bit(points, tmp_path, program):
    hologram = ht.Hologram.from_phase(
        ht.synthesize(points, ht.Slm(columns=64, rows=48, pitch=8e-6)).phase, 8e-6, 532e-9)
    hologram.save(tmp_path / "h.png")
    program("show", "h.png", "--distance", "100 mm", "--pupil", "4 mm", "--eye", "0, 0, 200 mm", "-o", "v.exr")
    leaving = ht.show(hologram, ht.Slm("pluto", columns=64, rows=48))
    picture = ht.expose(leaving, "100 mm", pupil="4 mm", eye=("0 m", 0, 0.2))
    assert equal(picture.pixels, ht.load_image(tmp_path / "v.exr").pixels)


def test_show_on_a_device_is_the_processors_to_rounding():
    hologram = ht.Hologram(np.random.default_rng(1).integers(0, 256, (24, 32)), "8 um", "532 nm")
    here = ht.show(hologram, tilt_x="0.5 deg")
    try:
        there = ht.show(hologram, tilt_x="0.5 deg", device="opencl")
    except ht.Error as error:
        assert "OpenCL" in str(error)  # none here
        pytest.skip(str(error))
    assert 0 < np.linalg.norm(there.samples - here.samples) < 2e-6 * np.linalg.norm(here.samples)


def test_a_panel_takes_all_keys_of_its_table(tmp_path):
    panel = ht.Slm("pluto", columns=np.int64(40), rows=30, fill_factor="80 %", crosstalk=0.2)
    assert (panel.shape, panel.levels, panel.fill_factor) == ((30, 40), 256, 0.8)
    assert "crosstalk" in panel.effects
    assert ht.Slm({"columns": 4, "rows": 3, "pitch": "8 um"}, levels=16).levels == 16
    assert ht.Slm("pluto").name == "pluto" and ht.Slm(columns=4, rows=3, pitch=8e-6).phase_range == 2 * np.pi
    (tmp_path / "mine.toml").write_text('preset = "pluto"\nbits = 10\n')
    assert ht.Slm(tmp_path / "mine.toml").levels == 1024
    assert ht.Slm(tmp_path / "mine.toml", rows=20).shape == (20, 1920)
    assert ht.Slm("ACME 4K", columns=4, rows=3, pitch="8 um").name == "ACME 4K"
    assert ht.Slm("pluto", columns=96, rows=54).name == "pluto"
    with pytest.raises(ht.Error, match='did you mean "pluto"'):
        ht.Slm("plutto", columns=4, rows=3, pitch="8 um")
    assert ht.Slm(preset="pluto", rows=20).shape == (20, 1920)
    with pytest.raises(ht.Error, match="columns, rows and pitch, got .*pixel_pitch"):
        ht.Slm(columns=4, rows=3, pixel_pitch="8 um")
    with pytest.raises(ht.Error, match='expected metres for "design_wavelength", got 532; write "532 nm"'):
        ht.Slm("pluto", design_wavelength=532)
    with pytest.raises(ht.Error, match='expected a part of 1 for "fill_factor", got 93; write 0.93 or "93 %"'):
        ht.Slm("pluto", fill_factor=93)
    with pytest.raises(ht.Error, match='unknown key "fill"'):
        ht.Slm("pluto", fill=0.9)


def test_a_panels_own_wavelength_is_the_usual_one():
    panel = ht.Slm("pluto", design_wavelength="520 nm")
    assert ht.limits(panel)["wavelength_m"] == 520e-9
    assert ht.limits(panel, wavelength="633 nm")["wavelength_m"] == 633e-9
    assert ht.limits(ht.Slm(columns=400, rows=300, pitch="8 um"))["wavelength_m"] == 632.8e-9


def test_show_of_a_bare_level_is_its_phase():
    """One level everywhere: order 0 is sqrt(E) exp(2 pi i level/M), less the roll-off of the pixels at its edges."""
    hologram = ht.Hologram(np.full((32, 32), 64), "8 um", "633 nm")
    u = ht.show(hologram, irradiance=4).samples[16, 16]
    assert u == pytest.approx(2j, abs=1e-2)  # the panel's edges ring by about 1/(pi 16 pixels) squared


def test_an_error_is_the_sentence_of_the_program(field, tmp_path, program_error):
    field.save(tmp_path / "f.npy")
    for distance, flag, given in (
        ("1 m", "--pitch", {"pitch": "-1 mm"}),
        ("1 km", "--method", {"method": "fresnell"}),
    ):
        value = next(iter(given.values()))
        sentence = program_error("propagate", "f.npy", "--distance", "1 m", flag, value, "-o", "g.npy")
        with pytest.raises(ht.Error) as raised:
            ht.propagate(field, "1 m", **given)
        said = sentence.removeprefix(f"{flag}: ")
        assert str(raised.value).replace(f' for "{flag[2:]}"', "") == said


def test_an_unknown_parameter_names_the_nearest(field):
    with pytest.raises(ht.Error, match='unknown parameter "periodical"; did you mean "periodic"'):
        ht.propagate(field, 0.1, periodical="fresnel")
    with pytest.raises(ht.Error, match='unknown parameter "shading"; it is for the triangles'):
        ht.synthesize(ht.Sources([[0, 0, -1]], wavelength=5e-7), shading="flat")


def test_a_wrong_noun_is_named():
    with pytest.raises(ht.Error, match=r"expected a Sources to sum, got ndarray; make one with ht.Sources\("):
        ht.synthesize(np.zeros((3, 3)))
    with pytest.raises(ht.Error, match=r"two images or two fields .* ndarray; a picture in an array becomes one by ht.Image"):
        ht.compare(np.ones((4, 4)), np.ones((4, 4)))
    with pytest.raises(ht.Error, match="a picture has no wavelength; give its wavelength"):
        ht.encode(np.ones((4, 4)), target_distances="200 mm")
    with pytest.raises(ht.Error, match=r"expected a Field to propagate, got ndarray; make one with ht.Field\("):
        ht.propagate(random_samples((4, 4)), 0.1)


def test_facts_are_those_of_the_report(points):
    u = ht.synthesize(points, ht.Slm(columns=64, rows=48, pitch=8e-6))
    assert u.facts["waves"] == 20 and u.facts["method"] in ("exact", "tiled", "planes")


def test_doubts_are_warnings(points):
    far = ht.Sources([[1, 0, -0.1]], wavelength=532e-9)  # its box misses the panel
    with pytest.warns(ht.ResultWarning, match="light no pixel"):
        ht.synthesize(far, ht.Slm(columns=8, rows=8, pitch=8e-6))
