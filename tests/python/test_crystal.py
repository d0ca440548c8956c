"""A panel's crystal between polarisers, against NumPy: thin slices of the crystal, and FFTs of the written fields."""

import numpy as np
import pytest

import holotrace as ht

LEVELS, PITCH, DESIGN = 16, 8e-6, 532e-9


def linear(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def plate(axis, delay):
    """A retarder: its slow axis gets exp(i delay)."""
    turn = np.array([[np.cos(axis), -np.sin(axis)], [np.sin(axis), np.cos(axis)]])
    return turn @ np.diag([np.exp(1j * delay), 1]) @ turn.T


def slices(director, twist, delay, count=1000):
    axes = director + twist * (np.arange(count) + 0.5) / count
    return [plate(axis, delay / count) for axis in axes]


def product(matrices):  # of what light meets one after the other
    all_of = np.eye(2)
    for matrix in matrices:
        all_of = matrix @ all_of
    return all_of


def bench(**keys):
    return {"preset": "ideal", "columns": LEVELS, "rows": 4, "pitch": PITCH, "levels": LEVELS,
            "design_wavelength": DESIGN, **keys}


def ramp(slm):
    level = np.tile(np.arange(LEVELS, dtype=np.uint16), (4, 1))
    return ht.Hologram(level, PITCH, DESIGN, levels=LEVELS)


@pytest.mark.parametrize("kind", ["reflective", "transmissive"])
@pytest.mark.parametrize("wavelength", [532e-9, 633e-9])
def test_levels_show_what_thin_slices_of_the_crystal_do(kind, wavelength):
    # The plates are no multiples of 45°, so that each sign counts.
    director, twist, first, last = 0.3, 1.1, 7.0, 1.0
    slm = bench(polariser="20 deg", analyser="-50 deg", plates_before=[{"axis": "10 deg", "delay": "70 deg"}],
                plates_behind=[{"axis": "-35 deg", "delay": "200 deg"}],
                crystal={"kind": kind, "director": f"{director} rad", "twist": f"{twist} rad",
                         "first_delay": f"{first} rad", "last_delay": f"{last} rad"})
    # One sample per pixel of the whole field: with a pixel whose levels are the same everywhere the field is its transmittance.
    stretch = DESIGN / wavelength
    passes = 2 if kind == "reflective" else 1
    for level in (0, 5, 15):
        delay = stretch * (first + (last - first) * level / LEVELS) / passes
        thin = slices(director, twist, delay)
        crystal = product(thin + thin[::-1] if kind == "reflective" else thin)
        before, behind = plate(np.radians(10), stretch * np.radians(70)), plate(np.radians(-35), stretch * np.radians(200))
        expected = linear(np.radians(-50)) @ behind @ crystal @ before @ linear(np.radians(20))
        same = ht.Hologram(np.full((4, LEVELS), level, np.uint16), PITCH, DESIGN, levels=LEVELS)
        shown = np.asarray(ht.show(same, slm, wavelength=wavelength))
        assert abs(shown - expected).max() < 2e-5  # of 1000 slices: 1e-5; single precision: 1e-6


def test_a_misaligned_polariser_sends_sine_squared_to_the_zero_order():
    # Analysers along and across the director give the fields of both polarisations.
    angle = 25
    light = {}
    for name, analyser in {"along": 0, "across": 90}.items():
        slm = bench(polariser=f"{angle} deg", analyser=f"{analyser} deg")
        light[name] = abs(np.fft.fft2(np.asarray(ht.show(ramp(slm), slm)), norm="forward")) ** 2
    assert light["across"][0, 0] == pytest.approx(np.sin(np.radians(angle)) ** 2, abs=1e-6)
    assert light["along"][0, 0] == pytest.approx(0, abs=1e-6)
    # Order 1 of a ramp of P levels has sinc²(1/P) by the steps, and again by the width of the pixels.
    assert light["along"][0, 1] == pytest.approx(np.cos(np.radians(angle)) ** 2 * np.sinc(1 / LEVELS) ** 2, abs=1e-6)


def test_views_add_both_polarisations():
    slm = bench(polariser="25 deg")
    hologram = ramp(slm)
    views = [np.asarray(ht.view(hologram, {**slm, **analyser}, distances="0.2 mm")[0], np.float64)
             for analyser in ({}, {"analyser": "10 deg"}, {"analyser": "100 deg"})]
    assert abs(views[0] - views[1] - views[2]).max() < 1e-5 * views[0].max()
    assert views[2].max() > 0.01 * views[0].max()


def test_a_field_of_two_polarisations_warns():
    slm = bench(polariser="25 deg")
    with pytest.warns(ht.ResultWarning, match="a field holds only the one that the levels modulate most"):
        ht.show(ramp(slm), slm)


def test_an_amplitude_hologram_takes_the_levels_of_its_amplitudes():
    # Between crossed polarisers at 45° a level shows |sin(pi level/256)|: the encoder's levels show |U|/max|U|.
    slm = {"preset": "ideal", "columns": 64, "rows": 4, "pitch": PITCH, "levels": 256, "polariser": "45 deg",
           "analyser": "-45 deg"}
    wanted = np.tile(np.linspace(0, 1, 64), (4, 1))
    hologram = ht.encode(ht.Field(wanted.astype(np.complex64), pitch=PITCH, wavelength=DESIGN), slm=slm, method="amplitude")
    # Half a step of the amplitudes that are asked for, 1/510, and half a step of those that are there, pi/512.
    assert abs(np.sin(np.pi * np.asarray(hologram) / 256) - wanted).max() < 1 / 510 + np.pi / 512
    assert hologram.facts["amplitude_most"] == pytest.approx(1)
    assert hologram.facts["amplitude_least"] == pytest.approx(0, abs=1e-9)


def test_a_dark_bench_says_so():
    slm = bench(polariser="0 deg", analyser="90 deg")
    field = ht.Field(np.ones((4, LEVELS), np.complex64), pitch=PITCH, wavelength=DESIGN)
    with pytest.warns(ht.ResultWarning, match="turn its polariser or its analyser"):
        ht.encode(field, slm=slm, method="phase")


def test_sgd_sees_through_coupled_levels():
    # Amplitude and phase of a twisted crystal go together: the nearest levels leave an error that iterations correct.
    slm = {"preset": "ideal", "columns": 64, "rows": 64, "pitch": PITCH, "levels": 256, "polariser": "0 deg",
           "analyser": "60 deg",
           "crystal": {"twist": "45 deg", "first_delay": "400 deg", "last_delay": "0 deg"}}
    picture = np.zeros((64, 64), np.float32)
    picture[24:40, 20:44] = 1
    quality = {}
    for method in ("gerchberg-saxton", "sgd"):
        target = ht.Image(picture, pitch=PITCH)
        found = ht.encode(target, slm=slm, wavelength=DESIGN, method=method, target_distances="20 mm", iterations=30,
                          start="random", seed=2)
        quality[method] = found.facts["psnr_db"]
    assert quality["sgd"] > quality["gerchberg-saxton"] + 3
