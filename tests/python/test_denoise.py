"""denoise, and which pictures of a scene are denoised."""

import numpy as np
import pytest

import holotrace as ht

WALL = {
    "wavelength": "532 nm",
    "slm": {"columns": 64, "rows": 48, "pitch": "8 um"},
    "background": 1.0,
    "light": [{"type": "rectangle", "corner": "-1 2 -29 mm", "edge_u": "2 0 0 mm", "edge_v": "0 1 1 mm", "radiance": 9}],
    "object": [{"type": "quad", "width": "9 mm", "height": "9 mm", "position": "0 0 -30 mm"}],
}


def noisy():
    """Even light of 4 paths per pixel, each exponentially distributed: a relative error of 0.5."""
    return ht.Image(np.random.default_rng(1).exponential(size=(4, 64, 64, 3)).mean(axis=0).astype(np.float32))


@pytest.fixture(name="library")
def _library():
    try:
        return ht.denoise(noisy()).facts["denoiser"]
    except ht.Error as missing:
        pytest.skip(str(missing))


def test_takes_the_noise_of_even_light(library):
    assert library.startswith("Open Image Denoise 2.")
    before = noisy()
    for fast in (False, True):
        after = ht.denoise(before, fast=fast)
        assert after.shape == before.shape
        # Neighbours that are averaged: an error below a tenth takes 25 of them, and the network sees hundreds.
        assert np.std(after.pixels) < np.std(before.pixels) / 5
        assert np.mean(after.pixels) == pytest.approx(np.mean(before.pixels), rel=5e-3)


def test_takes_guides_for_both_or_none(library):
    flat = ht.Image(np.full((64, 64, 3), 0.5, np.float32))
    assert ht.denoise(noisy(), flat, flat).shape == (64, 64, 3)
    with pytest.raises(ht.Error, match="expected normals on the picture's 64 x 64 pixels"):
        ht.denoise(noisy(), flat)


def test_renders_are_denoised_only_if_asked_for(library):
    scene = ht.Scene(WALL)
    size = {"columns": 32, "rows": 24, "paths": 2}
    plain, none, every = (ht.render(scene, **size, **more) for more in ({}, {"denoise": "none"}, {"denoise": "all"}))
    assert np.array_equal(plain.pixels, none.pixels)
    assert not np.array_equal(plain.pixels, every.pixels)
    assert every.facts["denoised"] == 1


def test_refuses_what_is_no_picture():
    with pytest.raises(ht.Error, match="expected finite light of 0 or more in a picture to denoise, got -1"):
        ht.denoise(ht.Image(np.full((20, 20), -1.0)))
