"""Fields and sources: what they are made from, and what NumPy sees of them."""

import copy
import pickle

import numpy as np
import pytest

import holotrace as ht
from conftest import random_samples


def test_numpy_sees_the_memory_of_a_field(field):
    array = np.asarray(field)
    assert array.shape == (33, 48) and array.dtype == np.complex64
    assert np.shares_memory(array, field.samples)
    array[3, 5] = 7j
    assert field.samples[3, 5] == 7j


def test_an_array_keeps_its_field_alive():
    array = np.asarray(ht.Field(np.ones((4, 5)), pitch=1e-6, wavelength=5e-7))
    assert (array == 1).all()


def test_dtype_copy_and_float_views_follow_numpy(field):
    assert np.asarray(field, dtype=np.complex128).dtype == np.complex128
    assert not np.shares_memory(np.array(field), field.samples)


@pytest.mark.parametrize("dtype", [np.complex64, np.complex128, np.float32, np.float64])
def test_a_field_keeps_the_precision_of_its_array(dtype):
    values = random_samples((5, 7), np.complex128)
    given = values.astype(dtype) if np.issubdtype(dtype, np.complexfloating) else values.real.astype(dtype)
    field = ht.Field(given, pitch=1e-6, wavelength=5e-7)
    assert field.dtype == (np.complex64 if given.itemsize in (4, 8) and dtype in (np.complex64, np.float32) else np.complex128)
    assert (field.samples == given).all()


@pytest.mark.parametrize(
    "change",
    [np.asfortranarray, lambda a: a[::2, ::3], lambda a: a[::-1], lambda a: a.T, lambda a: np.broadcast_to(a[0], a.shape)],
    ids=["Fortran order", "every other", "negative stride", "transposed", "stride 0"],
)
def test_arrays_of_any_layout_are_accepted(change):
    array = change(random_samples((12, 9)))
    assert (np.asarray(ht.Field(array, pitch=1e-6, wavelength=5e-7)) == array).all()


def test_a_read_only_array_is_accepted_and_not_changed():
    array = random_samples((4, 6))
    array.flags.writeable = False
    field = ht.Field(array, pitch=1e-6, wavelength=5e-7)
    field.samples[:] = 0
    assert array.any()


def test_lists_are_arrays():
    assert ht.Field([[1.0, 2.0], [3.0, 4.0]], pitch=1e-6, wavelength=5e-7).shape == (2, 2)


@pytest.mark.parametrize("rank", [0, 1, 3])
def test_a_wrong_rank_names_the_shape(rank):
    with pytest.raises(ht.Error, match=r"the shape \(rows, columns\), got an array of the shape"):
        ht.Field(np.ones((2,) * rank), pitch=1e-6, wavelength=5e-7)


def test_an_empty_array_is_refused():
    with pytest.raises(ht.Error, match=r"expected rows and columns .* \(0, 5\)"):
        ht.Field(np.ones((0, 5)), pitch=1e-6, wavelength=5e-7)


@pytest.mark.parametrize("dtype", [np.uint8, np.int64, bool, object, "U1"])
def test_a_wrong_dtype_is_refused(dtype):
    with pytest.raises(ht.Error, match="expected complex or real floating-point samples"):
        ht.Field(np.ones((2, 3)).astype(dtype), pitch=1e-6, wavelength=5e-7)


@pytest.mark.parametrize("bad", [np.nan, np.inf, complex(0, np.nan)])
@pytest.mark.parametrize("dtype", [np.complex64, np.complex128])
def test_a_number_that_is_not_finite_is_named_with_its_place(bad, dtype):
    array = np.ones((300, 400), dtype)  # several pieces of the parallel copy
    array[299, 7] = array[123, 45] = bad
    with pytest.raises(ht.Error, match="NaN or infinity at row 123, column 45"):
        ht.Field(array, pitch=1e-6, wavelength=5e-7)


def test_lengths_are_metres_or_texts_with_a_unit():
    for pitch in (8e-6, np.float64(8e-6), "8 um", "0.008 mm"):
        assert ht.Field(np.ones((2, 2)), pitch=pitch, wavelength="532 nm").pitch == pytest.approx(8e-6, rel=1e-15)


@pytest.mark.parametrize("given", [532, 532.0, 632.8])
def test_nanometres_given_as_metres_name_the_mistake(given):
    with pytest.raises(ht.Error, match=rf'got {given:g}, which is a wavelength of {given:g} m; write "{given:g} nm"'):
        ht.Field(np.ones((2, 2)), pitch=8e-6, wavelength=given)


@pytest.mark.parametrize("given", ["8", "8 yd", "eight", -8e-6, 0, None, True, 1j, [1], np.nan])
def test_an_invalid_pitch_is_refused_by_name(given):
    with pytest.raises(ht.Error, match='"pitch"'):
        ht.Field(np.ones((2, 2)), pitch=given, wavelength=532e-9)


def test_geometry_is_that_of_the_conventions():
    field = ht.Field(np.ones((3, 4)), pitch=2e-3, wavelength=5e-7, centre=(10e-3, 20e-3), z=-0.3)
    np.testing.assert_allclose(field.x, [7e-3, 9e-3, 11e-3, 13e-3], rtol=1e-12)  # x to the right
    np.testing.assert_allclose(field.y, [22e-3, 20e-3, 18e-3], rtol=1e-12)  # row 0 on top
    assert field.z == -0.3 and field.centre == (10e-3, 20e-3)
    assert field.power == pytest.approx(12 * 4e-6)  # 12 samples of 1 W/m2 on 2 mm x 2 mm each


def test_fields_survive_pickle_and_copy(field):
    moved = ht.propagate(field, 0.01, centre_x="0.1 mm")
    for other in (pickle.loads(pickle.dumps(moved)), copy.copy(moved), copy.deepcopy(moved)):
        assert (other.samples == moved.samples).all() and not np.shares_memory(other.samples, moved.samples)
        assert (other.z, other.centre, other.wavelength, other.facts) == (
            moved.z, moved.centre, moved.wavelength, moved.facts)


def test_sources_survive_pickle_and_copy(points):
    for other in (pickle.loads(pickle.dumps(points)), copy.copy(points)):
        assert (other.positions == points.positions).all() and (other.phases == points.phases).all()
        assert len(other) == 20 and other.wavelength == points.wavelength


def test_a_damaged_pickle_is_an_error(field):
    state = field._core.__getstate__()
    for bad in (state[:-1], state + b"x", b"", b"\xff" * 40):
        with pytest.raises(ht.Error):
            type(field._core).__new__(type(field._core)).__setstate__(bad)


def test_sources_are_views(points):
    points.amplitudes[0] = 3
    points.positions[0] = (0, 0, -0.5)
    assert points.amplitudes[0] == 3 and points.positions[0, 2] == -0.5
    assert points.positions.shape == (20, 3)


def test_astigmatic_sources_have_the_field_of_their_formula(tmp_path):
    first, second = np.array([0.1e-3, 0, -0.08]), np.array([0.1e-3, 0, -0.05])
    sources = ht.Sources(
        [first, [0, 0, -0.1]], [2, 0], wavelength=532e-9, second_foci=[second, [0, 0, -1]], focal_lines=[[0, 1, 0], [0, 0, 0]]
    )
    field = ht.synthesize(sources, ht.Slm(columns=32, rows=24, pitch="8 um"), method="exact")
    x = (np.arange(32) - 15.5) * 8e-6 - first[0]
    y = (11.5 - np.arange(24)[:, None]) * 8e-6
    rho, apart = np.hypot(x, 0.08), 0.03
    s = np.hypot(rho - apart, y)
    expected = 2 * np.sqrt(0.08 * 0.05 * (rho - apart) / rho) / s * np.exp(2j * np.pi * ((s + apart) / 532e-9 % 1))
    assert np.abs(field.samples - expected).max() < 1e-6  # floats
    sources.save(tmp_path / "s.ply")
    for same in (ht.load_sources(tmp_path / "s.ply"), pickle.loads(pickle.dumps(sources))):
        assert (same.second_foci == [second, [0, 0, -1]]).all()
        assert (same.focal_lines == [[0, 1, 0], [0, 0, 0]]).all()
    assert ht.Sources([[0, 0, -1]], wavelength=5e-7).second_foci.shape == (0, 3)


@pytest.mark.parametrize(
    "foci, lines, message",
    [
        ([[0, 0, -2], [0, 0, -2]], [[0, 1, 0], [0, 1, 0]], r"shape \(1, 3\)"),
        ([[0, 0, -2]], None, r"shape \(1, 3\)"),
        ([0, 0, -2], [[0, 1, 0]], r"\(n, 3\)"),
        ([[0, 0, -2]], [[0, 2, 0]], "unit vector"),
        ([[0, 0, -2]], [[0, 0, 1]], "right angles"),
        ([[0, 0, -1]], [[0, 1, 0]], "another depth"),
        ([[0, 0, np.nan]], [[0, 1, 0]], "finite"),
    ],
)
def test_bad_second_foci_are_refused(foci, lines, message):
    with pytest.raises(ht.Error, match=message):
        ht.Sources([[0, 0, -1]], wavelength=5e-7, second_foci=foci, focal_lines=lines)


@pytest.mark.parametrize(
    "places, message",
    [([[0, 0, 0]], "behind the panel"), ([[0, 0]], r"\(n, 3\)"), ([0, 0, -1], r"\(n, 3\)"), ([[0, 0, np.nan]], "finite")],
)
def test_bad_sources_are_refused(places, message):
    with pytest.raises(ht.Error, match=message):
        ht.Sources(places, wavelength=5e-7)


def test_files_are_those_of_the_program(field, tmp_path, program):
    field.save(tmp_path / "f.npy")
    program("propagate", "f.npy", "--distance", "0 m", "-o", "g.npy")
    assert (ht.load_field(tmp_path / "g.npy").samples == field.samples).all()
    double = field.astype(np.complex128)
    double.save(tmp_path / "d.npy")
    assert ht.load_field(tmp_path / "d.npy", double=True).dtype == np.complex128
    ht.save_fields(tmp_path / "two.npy", [field, ht.Field(field, field.pitch, "532 nm")])
    assert [f.wavelength for f in ht.load_fields(tmp_path / "two.npy")] == [632.8e-9, 532e-9]
    with pytest.raises(ht.Error, match="got 2; use load_fields"):
        ht.load_field(tmp_path / "two.npy")


def test_reprs_state_what_a_field_is(field):
    assert repr(field).startswith("Field(48 x 33, complex64, pitch=8 um, wavelength=632.8 nm, power=")
    assert repr(ht.Sources([[0, 0, -1]], wavelength=5e-7)) == "Sources(1 waves, wavelength=500 nm)"


def test_a_notebook_shows_pictures(field):
    page = field._repr_html_()
    assert page.count("data:image/png;base64,") == 2 and "irradiance" in page and "phase" in page
