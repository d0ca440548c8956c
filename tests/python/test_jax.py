"""holotrace.jax: values of the verbs, and gradients against differences."""

import os

import numpy as np
import pytest

os.environ["XLA_FLAGS"] = os.environ.get("XLA_FLAGS", "") + " --xla_force_host_platform_device_count=2"

import holotrace as ht
from conftest import random_samples

jax = pytest.importorskip("jax", reason="jax is not installed; pip install jax")
import jax.numpy as jnp  # noqa: E402
import holotrace.jax as htj  # noqa: E402
from jax.test_util import check_grads  # noqa: E402

jax.config.update("jax_enable_x64", True)


def test_results_and_gradients_are_on_the_device_of_the_array():
    """Two devices of XLA's own making stand for an accelerator; they are there if nothing has used JAX before."""
    panel = ht.Slm(columns=7, rows=6, pitch=8e-6)
    space, shown = htj.Propagation((6, 7), "8 um", "532 nm", "0.5 mm"), htj.Modulator(panel, "532 nm")
    seen = htj.Camera((6, 7), "8 um", "532 nm", "0.5 mm", pupil="70 um", eye=(0, 0, "0.3 mm"))
    losses = {"propagation": lambda u: (jnp.abs(space(u)) ** 2)[2, 3], "panel": lambda u: shown(jnp.abs(u)).real[2, 3],
              "camera": lambda u: seen(u)[2, 3]}
    u = random_samples((6, 7), np.complex128)
    first, last = jax.devices()[0], jax.devices()[-1]
    assert first != last
    for name, loss in losses.items():
        there, here = (jax.value_and_grad(loss)(jax.device_put(u, device)) for device in (last, first))
        for one, other in zip(there, here):
            assert one.devices() == {last} and other.devices() == {first}, name
            assert one.dtype == other.dtype and (np.asarray(one) == np.asarray(other)).all(), name
        assert there[1].dtype == u.dtype


@pytest.mark.parametrize("dtype", [np.complex64, np.complex128])
def test_propagate_is_the_verb_bit_by_bit(dtype):
    u = random_samples((12, 17), dtype)
    moved = htj.propagate(u, "3 mm", pitch="8 um", wavelength="532 nm", method="angular-spectrum")
    field = ht.propagate(ht.Field(u, "8 um", "532 nm"), "3 mm", method="angular-spectrum")
    assert moved.dtype == dtype and np.asarray(moved).tobytes() == field.samples.tobytes()


@pytest.mark.parametrize("params", [{}, {"columns": 9, "rows": 8}, {"centre_x": "16 um"}, {"periodic": True}], ids=str)
def test_gradients_of_both_orders_are_differences(params):
    """In double precision, as JAX checks them: some 1e-5 of each, by differences over 1e-5. The loss is of fourth order."""
    space = htj.Propagation((6, 7), "8 um", "532 nm", "0.5 mm", **params)
    check_grads(lambda u: (jnp.abs(space(u)) ** 4).sum(), (random_samples((6, 7), np.complex128),), order=2, modes="rev",
                rtol=1e-4)


def test_jit_and_vmap_give_the_same():
    space = htj.Propagation((5, 6), "8 um", "532 nm", "1 mm")
    u = random_samples((2, 3, 5, 6), np.complex128)
    each = np.stack([[space(u[i, j]) for j in range(3)] for i in range(2)])
    assert (np.asarray(space(u)) == each).all()
    assert (np.asarray(jax.jit(jax.vmap(jax.vmap(space)))(u)) == each).all()
    loss = lambda v: (jnp.abs(space(v)) ** 2).sum()  # noqa: E731
    one_by_one = np.stack([jax.grad(loss)(u[0, j]) for j in range(3)])
    assert np.allclose(jax.jit(jax.vmap(jax.grad(loss)))(u[0]), one_by_one, rtol=1e-13, atol=0)


def test_slm_is_show_bit_by_bit():
    panel = ht.Slm(columns=16, rows=12, pitch=8e-6)
    level = np.random.default_rng(1).integers(0, 256, (12, 16))
    shown = ht.show(ht.Hologram(level, "8 um", "532 nm"), panel, subpixels=3)
    light = htj.slm(level, panel, wavelength="532 nm", subpixels=3)
    assert np.asarray(light).tobytes() == shown.samples.tobytes()


@pytest.mark.parametrize("subpixels", [1, 3])
def test_gradients_of_slm_are_differences(subpixels):
    """The panel computes in float: see tests/python/test_torch.py for the tolerance."""
    light = htj.Modulator(ht.Slm(columns=6, rows=5, pitch=8e-6), "532 nm", subpixels=subpixels)
    level = np.random.default_rng(1).uniform(20, 220, (5, 6))
    weight = random_samples((5 * subpixels, 6 * subpixels), np.complex128)

    def value(given):
        return (light(given) * weight).real.sum()

    gradient = jax.grad(value)(level)
    for row, column in ((0, 0), (2, 3), (4, 5)):
        step = np.zeros((5, 6))
        step[row, column] = 0.5
        assert gradient[row, column] == pytest.approx(float(value(level + step) - value(level - step)), abs=2e-5 * subpixels**2)


def test_the_camera_is_expose():
    """Through a pupil off the axis, to the float rounding of propagation."""
    u = random_samples((40, 48))
    seen = htj.Camera((40, 48), "8 um", "532 nm", "20 mm", pupil="0.1 mm", eye=("40 um", 0, "15 mm"))(u)
    expected = ht.expose(ht.Field(u, "8 um", "532 nm"), "20 mm", pupil="0.1 mm", eye=("40 um", 0, "15 mm"), sampling="point")
    assert np.abs(np.asarray(seen) - expected.pixels).max() <= 1e-5 * expected.pixels.max()


def test_camera_and_gradient_are_those_of_torch():
    torch = pytest.importorskip("torch", reason="torch is not installed; pip install torch")
    import holotrace.torch as htt

    panel = ht.Slm(columns=24, rows=20, pitch=8e-6)
    phase = np.random.default_rng(2).uniform(0, 6, panel.shape)
    arguments = (panel.shape, panel.pitch, "532 nm", "20 mm")
    more = dict(pupil="0.1 mm", eye=("20 um", 0, "10 mm"), binning=2)
    tensor = torch.from_numpy(phase).requires_grad_()
    ours, theirs = htj.Camera(*arguments, **more), htt.Camera(*arguments, **more)
    loss = (theirs(htt.Modulator(panel, "532 nm").of_phase(tensor)) ** 2).sum()
    loss.backward()
    value, gradient = jax.value_and_grad(lambda p: (ours(htj.Modulator(panel, "532 nm").of_phase(p)) ** 2).sum())(phase)
    assert float(value) == pytest.approx(loss.item(), rel=1e-5)
    assert np.allclose(gradient, tensor.grad.numpy(), rtol=0, atol=1e-5 * np.abs(gradient).max())


def test_an_optimisation_finds_a_picture():
    """Gradient descent under jit; the loss falls to less than half within 40 steps, as in test_torch.py."""
    panel = ht.Slm(columns=48, rows=40, pitch=8e-6)
    modulator, camera = htj.Modulator(panel, "532 nm"), htj.Camera(panel.shape, panel.pitch, "532 nm", "10 mm", image="real")
    target = np.zeros(panel.shape)
    target[12:28, 14:34] = 1.5

    @jax.jit
    def step(phase, momentum):
        def loss(p):
            return ((jnp.sqrt(camera(modulator.of_phase(p)) + 1e-6) - target) ** 2).mean()

        value, slope = jax.value_and_grad(loss)(phase)
        momentum = 0.9 * momentum + slope
        return phase - 100.0 * momentum, momentum, value

    phase = np.random.default_rng(1).uniform(0, 6, panel.shape)
    momentum, values = np.zeros(panel.shape), []
    for _ in range(40):
        phase, momentum, value = step(phase, momentum)
        values.append(float(value))
    assert values[-1] < 0.5 * values[0]


def test_levels_are_rounded_with_a_gradient_of_one():
    assert htj.round_levels(jnp.array([1.4, 2.6])).tolist() == [1.0, 3.0]
    assert jax.grad(lambda level: htj.round_levels(level).sum())(jnp.array([1.4, 2.6])).tolist() == [1.0, 1.0]


def test_bad_arrays_are_refused():
    with pytest.raises(ht.Error, match="expected a complex64 or complex128 array, got float"):
        htj.propagate(np.ones((3, 3)), 0.1, pitch=8e-6, wavelength=5e-7)
    with pytest.raises(ht.Error, match=r"the shape \(..., rows, columns\), got \(3,\)"):
        htj.propagate(np.ones(3), 0.1, pitch=8e-6, wavelength=5e-7)
    with pytest.raises(ht.Error, match=r"samples of the shape \(..., 4, 4\), got \(3, 3\)"):
        htj.Propagation((4, 4), 8e-6, 5e-7, 0.01)(np.ones((3, 3), complex))
    with pytest.raises(ht.Error, match=r"levels of the shape \(..., 2, 2\), got \(3, 3\)"):
        htj.slm(np.ones((3, 3)), ht.Slm(columns=2, rows=2, pitch=8e-6), wavelength="532 nm")
