"""Arguments of wrong kinds and shapes: each is accepted, or refused by ht.Error. Nothing else is raised, nothing crashes."""

import warnings

import numpy as np
import pytest

import holotrace as ht

GOOD = np.ones((4, 5), np.float32)
BAD = {
    "None": None, "text": "x", "whole number": 3, "list": [1, 2], "dict": {}, "rows of two lengths": [[1], [1, 2]],
    "huge whole number": [[10**30]], "scalar": np.float32(1), "1-d": np.ones(3), "3-d": np.ones((2, 3, 4)),
    "5-d": np.ones((1,) * 5), "empty": np.ones((0, 3)), "NaN": np.full((4, 5), np.nan), "huge": np.full((4, 5), 1e300),
    "objects": np.array([[object()]]), "bool": np.ones((4, 5), bool), "uint8": np.ones((4, 5), np.uint8),
    "complex": np.ones((4, 5), complex), "texts": np.array([["a"]]), "dates": np.array([["2020-01-01"]], "M8[D]"),
    "records": np.zeros((2, 2), [("a", "f4")]), "negative": -GOOD, "long double": np.ones((4, 5), np.longdouble),
    "half": np.ones((4, 5), np.float16), "big-endian": np.ones((4, 5), ">f8"),
    "masked": np.ma.masked_array(GOOD, mask=np.eye(4, 5)), "matrix": np.matrix(GOOD),
}


def field():
    return ht.Field(GOOD, 1e-6, 5e-7)


def hologram():
    return ht.Hologram(np.zeros((4, 4), int), 1e-6, 5e-7)


def depths():
    return ht.DepthImage(GOOD, GOOD), ht.Slm(columns=8, rows=8, pitch=8e-6)


def mesh(**more):
    return ht.Scene(wavelength=5e-7, object=[{"type": "mesh", "faces": [[0, 1, 2]], "position": (0, 0, -1), **more}])


STACK = (ht.FocalStack([GOOD], [0.1], 1e-6), ht.Slm(columns=5, rows=4, pitch=1e-6))
CALLS = {
    "Field": lambda a: ht.Field(a, 1e-6, 5e-7),
    "Field pitch": lambda a: ht.Field(GOOD, a, 5e-7),
    "Field wavelength": lambda a: ht.Field(GOOD, 1e-6, a),
    "Field centre": lambda a: ht.Field(GOOD, 1e-6, 5e-7, centre=a),
    "Field image": lambda a: ht.Field(GOOD, 1e-6, 5e-7, image=a),
    "Field name": lambda a: ht.Field(GOOD, 1e-6, 5e-7, name=a),
    "Hologram": lambda a: ht.Hologram(a, 1e-6, 5e-7),
    "Hologram levels": lambda a: ht.Hologram(np.zeros((2, 2), int), 1e-6, 5e-7, levels=a),
    "Hologram slm": lambda a: ht.Hologram(np.zeros((2, 2), int), 1e-6, 5e-7, slm=a),
    "from_phase": lambda a: ht.Hologram.from_phase(a, 1e-6, 5e-7),
    "from_phase levels": lambda a: ht.Hologram.from_phase(GOOD, 1e-6, 5e-7, levels=a),
    "Image": ht.Image,
    "Image pitch": lambda a: ht.Image(GOOD, a),
    "DepthImage picture": lambda a: ht.DepthImage(a, GOOD),
    "DepthImage depth": lambda a: ht.DepthImage(GOOD, a),
    "FocalStack": lambda a: ht.FocalStack(a, [0.1], 1e-6),
    "FocalStack distances": lambda a: ht.FocalStack([GOOD], a, 1e-6),
    "Sources": lambda a: ht.Sources(a, wavelength=5e-7),
    "Sources amplitudes": lambda a: ht.Sources([[0, 0, -1]], a, wavelength=5e-7),
    "Sources phases": lambda a: ht.Sources([[0, 0, -1]], 1, a, wavelength=5e-7),
    "Slm columns": lambda a: ht.Slm(columns=a, rows=3, pitch=1e-6),
    "Slm levels": lambda a: ht.Slm(columns=3, rows=3, pitch=1e-6, levels=a),
    "Slm modulation": lambda a: ht.Slm(columns=3, rows=3, pitch=1e-6, modulation=a),
    "propagate": lambda a: ht.propagate(a, 0.1),
    "propagate distance": lambda a: ht.propagate(field(), a),
    "propagate columns": lambda a: ht.propagate(field(), 0.1, columns=a),
    "propagate method": lambda a: ht.propagate(field(), 0.1, method=a),
    "expose distance": lambda a: ht.expose(field(), a),
    "expose propagate": lambda a: ht.expose(field(), 1e-4, propagate=a),
    "encode": ht.encode,
    "encode_all": ht.encode_all,
    "encode effects": lambda a: ht.encode(field(), effects=a),
    "encode frames": lambda a: ht.encode_all(*STACK, wavelength=5e-7, method="sgd", iterations=1, frames=a),
    "view": ht.view,
    "view show": lambda a: ht.view(hologram(), show=a, distances=1e-4),
    "view eye": lambda a: ht.view(hologram(), eye=a, distances=1e-4),
    "view eye_separation": lambda a: ht.view(hologram(), eye_separation=a, distances=1e-4),
    "compare": lambda a: ht.compare(a, a),
    "register": lambda a: ht.register(a, a),
    "anaglyph": lambda a: ht.anaglyph(a, a),
    "limits distance": lambda a: ht.limits(distance=a),
    "depth_image_fields": ht.depth_image_fields,
    "depth_image_fields frame": lambda a: ht.depth_image_fields(*depths(), frame=a),
    "depth_image_fields synthesize": lambda a: ht.depth_image_fields(*depths(), synthesize=a),
    "Scene": ht.Scene,
    "Scene wavelength": lambda a: ht.Scene(wavelength=a),
    "Scene object": lambda a: ht.Scene(wavelength=5e-7, object=a),
    "Scene vertices": lambda a: mesh(vertices=a),
    "Scene points": lambda a: ht.Scene(wavelength=5e-7, object=[{"type": "points", "points": a}]),
    "Scene texture": lambda a: ht.Scene(wavelength=5e-7, materials={"m": {"texture": a}}),
    "run": ht.run,
    "save_fields": lambda a: ht.save_fields("/dev/null/f.npy", a),
    "Image.save white": lambda a: ht.Image(GOOD).save("/dev/null/p.png", white=a),
}


@pytest.mark.parametrize("name", CALLS)
def test_a_bad_argument_is_an_error_in_words(name):
    refused = 0
    for kind, value in BAD.items():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                CALLS[name](value)
            except ht.Error as error:
                assert str(error), kind
                refused += 1
            except Exception as error:
                pytest.fail(f"{kind}: {type(error).__name__}: {error}")
    assert refused >= 5


def test_the_number_of_threads_is_checked():
    for bad in (-1, 1.5, "two", None):
        with pytest.raises(ht.Error, match='"threads"'):
            ht.set_threads(bad)


def test_some_sentences():
    """A few of them, so that they stay plain."""
    for call, value, sentence in (
        ("Field", [[1], [1, 2]], "expected an array for the samples of a field: "),
        ("view show", 3, 'expected a dict of parameters for "show", got int'),
        ("encode frames", "two", 'expected a whole number for "frames", got .two.'),
        ("Slm levels", 10**12, 'expected a whole number from 0 to 2147483647 for "levels", got 1000000000000'),
        ("Hologram slm", "pluto", r"expected an Slm for the hologram's panel, got str; make one with ht.Slm\(...\)"),
        ("Field", BAD["masked"], "expected an array without masked values for the samples of a field"),
        ("view", None, "expected a hologram or several to view, got NoneType"),
    ):
        with pytest.raises(ht.Error, match=sentence):
            CALLS[call](value)


def test_a_long_bare_length_is_meant_in_another_unit():
    """A text says what it means."""
    field = ht.Field(np.ones((8, 8)), pitch="8 um", wavelength="532 nm")
    with pytest.raises(ht.Error, match='expected metres for "distance", got 300; write "300 mm", or "300 m" if you mean it'):
        ht.propagate(field, 300)
    assert ht.propagate(field, "300 m").z == 300


def test_metres_without_their_exponent():
    with pytest.raises(ht.Error, match='expected a pitch in metres of at most 100 mm, got 8 m; write "8 um"'):
        ht.Field(GOOD, pitch=8, wavelength="532 nm")
    with pytest.raises(ht.Error, match="expected metres"):
        ht.Field(GOOD, pitch=8e-6, wavelength=532)
