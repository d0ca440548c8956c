"""Tensors of other libraries, on the host and on devices, by DLPack: into nouns by their own copy, out of nouns without one."""

import gc

import numpy as np
import pytest

import holotrace as ht
from conftest import random_samples

CUDA = (2, 0)


class OnlyDLPack:
    """An array on the host that speaks DLPack and nothing else."""

    def __init__(self, values):
        self._values = values

    def __dlpack__(self, **wanted):
        return self._values.__dlpack__(**wanted)

    def __dlpack_device__(self):
        return self._values.__dlpack_device__()


class OnDevice(OnlyDLPack):
    """An array on a device, as CuPy's: NumPy may not read it, and only the method named ``by`` brings it to the host."""

    def __init__(self, values, by):
        super().__init__(values)
        self._by, self.copies = by, 0

    def _copy(self):
        self.copies += 1
        return self._values.copy()

    def __getattr__(self, name):
        if name == self.__dict__.get("_by"):
            return self._copy
        raise AttributeError(name)

    def __array__(self, dtype=None, copy=None):
        raise TypeError("Implicit conversion to a NumPy array is not allowed.")

    def __dlpack__(self, **wanted):
        raise BufferError("it is on a device")

    def __dlpack_device__(self):
        return CUDA


PICTURE = np.random.default_rng(1).uniform(size=(4, 5)).astype(np.float32)
LEVELS = np.random.default_rng(2).integers(0, 256, (4, 5))
PLACES = np.array([[0, 0, -0.1], [1e-3, 0, -0.2]])
NOUNS = {
    "Field": (random_samples((4, 5)), lambda a: ht.Field(a, 8e-6, 532e-9).samples),
    "Field in double": (random_samples((4, 5), np.complex128), lambda a: ht.Field(a, 8e-6, 532e-9).samples),
    "Hologram": (LEVELS, lambda a: ht.Hologram(a, 8e-6, 532e-9).level),
    "Hologram of phases": (PICTURE, lambda a: ht.Hologram.from_phase(a, 8e-6, 532e-9).level),
    "Image": (PICTURE, lambda a: ht.Image(a).pixels),
    "DepthImage": (PICTURE, lambda a: ht.DepthImage(PICTURE, a).depth),
    "FocalStack": (np.stack([PICTURE, 2 * PICTURE]), lambda a: np.asarray(ht.FocalStack(a, [0.1, 0.2], 8e-6))),
    "Sources": (PLACES, lambda a: ht.Sources(a, wavelength=532e-9).positions),
    "amplitudes": (np.array([1.0, 2.0]), lambda a: ht.Sources(PLACES, a, wavelength=532e-9).amplitudes),
}


@pytest.mark.parametrize("name", NOUNS)
def test_nouns_take_tensors_of_any_device(name):
    values, noun_of = NOUNS[name]
    expected = noun_of(values)
    for by in ("get", "cpu"):
        tensor = OnDevice(values, by)
        assert np.array_equal(noun_of(tensor), expected) and tensor.copies == 1
    assert np.array_equal(noun_of(OnlyDLPack(values)), expected)


def test_scenes_take_tensors_of_any_device():
    """A mesh, its picture and points on a device are those of arrays, bit by bit in their waves."""

    def waves_with(given):
        scene = ht.Scene(
            wavelength="532 nm", slm={"preset": "pluto", "columns": 48, "rows": 36}, trace={"columns": 8, "rows": 8, "paths": 1},
            materials={"paper": {"texture": given(PICTURE)}},
            object=[
                {"type": "mesh", "material": "paper", "position": (0, 0, -0.1), "faces": given(np.array([[0, 1, 2]])),
                 "vertices": given(np.array([[-2e-3, -2e-3, 0], [2e-3, -2e-3, 0], [0, 2e-3, 0]])),
                 "uv": given(np.array([[0.0, 0], [1, 0], [0.5, 1]]))},
                {"type": "points", "points": given(PLACES), "amplitudes": given(np.array([1.0, 2.0]))},
            ],
            light=[{"type": "directional", "direction": given(np.array([0, 0, -1.0])), "irradiance": 3}])
        (waves,) = ht.trace(scene)
        return waves.positions.tobytes() + waves.amplitudes.tobytes()

    assert waves_with(lambda array: OnDevice(array, "get")) == waves_with(lambda array: array)


def test_a_tensor_that_stays_on_its_device_is_an_error_in_words():
    with pytest.raises(ht.Error, match="^expected an array for the samples of a field: Implicit conversion .*; give its values as an array"):
        ht.Field(OnDevice(PICTURE, "nothing"), 8e-6, 532e-9)


class MovesByDLPack(OnlyDLPack):
    """An array on a device that DLPack itself copies to the host, which NumPy asks for since version 2.1."""

    def __dlpack__(self, *, dl_device=CUDA, **wanted):
        if dl_device != (1, 0):
            raise BufferError("it is on a device")
        return self._values.copy().__dlpack__()

    def __dlpack_device__(self):
        return CUDA


def test_a_tensor_may_be_copied_by_dlpack_alone():
    if np.lib.NumpyVersion(np.__version__) >= "2.1.0":
        assert np.array_equal(ht.Image(MovesByDLPack(PICTURE)).pixels, PICTURE)
    else:
        with pytest.raises(ht.Error, match="expected an array for an image: .*from_dlpack.*; give its values as an array of NumPy"):
            ht.Image(MovesByDLPack(PICTURE))


PLANES = {
    "Field": lambda: ht.Field(random_samples((4, 6)), 8e-6, 532e-9),
    "Field in double": lambda: ht.Field(random_samples((4, 6), np.complex128), 8e-6, 532e-9),
    "Image": lambda: ht.Image(PICTURE),
    "colours": lambda: ht.Image(np.random.default_rng(1).uniform(size=(4, 5, 3))),
    "Hologram": lambda: ht.Hologram(LEVELS, 8e-6, 532e-9),
}


@pytest.mark.parametrize("name", PLANES)
def test_numpy_sees_the_memory_of_nouns_by_dlpack(name):
    plane = PLANES[name]()
    assert plane.__dlpack_device__() == (1, 0)
    assert np.shares_memory(np.from_dlpack(plane), np.asarray(plane))


def test_a_stack_is_a_copy():
    stack = ht.FocalStack([PICTURE, 2 * PICTURE], [0.1, 0.2], 8e-6)
    assert np.array_equal(np.from_dlpack(stack), np.stack([PICTURE, 2 * PICTURE]))


# uint16, the levels of holograms, came to PyTorch with version 2.3.
@pytest.mark.parametrize("name", [name for name in PLANES if name != "Hologram"])
def test_torch_sees_the_memory_of_nouns(name):
    torch = pytest.importorskip("torch", reason="torch is not installed; pip install torch")
    plane = PLANES[name]()
    expected = np.asarray(plane).copy()
    tensor = torch.from_dlpack(plane)
    assert tensor.data_ptr() == np.asarray(plane).ctypes.data and np.array_equal(tensor.numpy(), expected)
    tensor[0, 0] = 0.5
    assert (np.asarray(plane)[0, 0] == 0.5).all()
    del plane  # the memory lives as long as the tensor
    gc.collect()
    assert np.array_equal(tensor[1:].numpy(), expected[1:])


@pytest.mark.parametrize("name", PLANES)
def test_jax_sees_the_memory_of_nouns(name):
    """But that of pictures: JAX copies what does not begin at a multiple of 64 bytes, as they may not."""
    jax = pytest.importorskip("jax", reason="jax is not installed; pip install jax")
    jax.config.update("jax_enable_x64", True)
    plane = PLANES[name]()
    array = jax.dlpack.from_dlpack(plane)
    assert isinstance(plane, ht.Image) or array.unsafe_buffer_pointer() == np.asarray(plane).ctypes.data
    assert np.array_equal(np.asarray(array), np.asarray(plane))


def test_tensors_of_torch_need_no_preparation():
    """One with a gradient, a view that is conjugate, one that is negative, and one that is transposed."""
    torch = pytest.importorskip("torch", reason="torch is not installed; pip install torch")
    u = random_samples((4, 5))
    tensor = torch.from_numpy(u)
    for given, expected in ((tensor.clone().requires_grad_(), u), (tensor.conj(), u.conj()), (tensor.T, u.T),
                            (tensor.conj().imag, -u.imag), (tensor.clone().requires_grad_().conj(), u.conj())):
        assert np.array_equal(ht.Field(given, 8e-6, 532e-9).samples, expected)
    with pytest.raises(ht.Error, match="expected an array for the samples of a field: .*BFloat16"):
        ht.Field(torch.ones(2, 2, dtype=torch.bfloat16), 8e-6, 532e-9)
    with pytest.raises(ht.Error, match="expected an array for an image: .*meta"):
        ht.Image(torch.ones(2, 2, device="meta"))


def test_tensors_on_the_host_are_not_copied():
    """Apart from the one copy into the noun's own memory."""
    torch = pytest.importorskip("torch", reason="torch is not installed; pip install torch")
    from holotrace._arrays import array_of

    u = random_samples((4, 5))
    for given in (u, torch.from_numpy(u), torch.from_numpy(u).requires_grad_(), OnlyDLPack(u)):
        assert np.shares_memory(array_of(given, "samples"), u)


def test_arrays_of_jax_make_nouns():
    jax = pytest.importorskip("jax", reason="jax is not installed; pip install jax")
    u = random_samples((4, 5))
    assert np.array_equal(ht.Field(jax.numpy.asarray(u), 8e-6, 532e-9).samples, u)
