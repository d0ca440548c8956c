"""holotrace.torch: values of the verbs, and gradients against differences."""

import numpy as np
import pytest

import holotrace as ht

torch = pytest.importorskip("torch", reason="torch is not installed; pip install torch")
import holotrace.torch as htt  # noqa: E402


def samples(shape, dtype=torch.complex128, seed=1):
    generator = torch.Generator().manual_seed(seed)
    return torch.randn(shape, dtype=dtype, generator=generator)


def test_propagate_is_the_verb_bit_by_bit():
    u = samples((12, 17))
    moved = htt.propagate(u, "3 mm", pitch="8 um", wavelength="532 nm", method="angular-spectrum")
    field = ht.propagate(ht.Field(u, "8 um", "532 nm"), "3 mm", method="angular-spectrum")
    assert moved.numpy().tobytes() == field.samples.tobytes()


@pytest.mark.parametrize(
    "params",
    [{}, {"columns": 9, "rows": 8}, {"centre_x": "16 um"}, {"periodic": True}, {"method": "fresnel"}],
    ids=str,
)
def test_gradients_of_propagate_pass_gradcheck_in_double(params):
    u = samples((6, 7)).requires_grad_()
    space = htt.Propagation((6, 7), "8 um", "532 nm", "0.5 mm", **params)
    assert torch.autograd.gradcheck(space, u)
    assert torch.autograd.gradgradcheck(space, u)


def test_the_adjoint_is_that_of_the_inner_product():
    """<Tu, v> = <u, T^H v> to rounding of double, for windows of different sizes."""
    space = htt.Propagation((6, 7), "8 um", "532 nm", "0.5 mm", columns=9, rows=8)
    u, v = samples((6, 7)), samples((8, 9), seed=2)
    left, right = torch.vdot(v.ravel(), space(u).ravel()), torch.vdot(space.adjoint(v).ravel(), u.ravel())
    assert abs(left - right) <= 1e-14 * 42 * abs(left)


def test_batches_are_computed_one_by_one():
    space = htt.Propagation((5, 6), "8 um", "532 nm", "1 mm")
    u = samples((2, 3, 5, 6))
    assert torch.equal(space(u)[1, 2], space(u[1, 2])) and space(u).shape == u.shape
    assert torch.autograd.gradcheck(space, u[:, :1].clone().requires_grad_())


def test_slm_is_show_bit_by_bit():
    panel = ht.Slm(columns=16, rows=12, pitch=8e-6)
    level = np.random.default_rng(1).integers(0, 256, (12, 16))
    shown = ht.show(ht.Hologram(level, "8 um", "532 nm"), panel, subpixels=3)
    light = htt.slm(torch.from_numpy(level.astype(np.float32)), panel, wavelength="532 nm", subpixels=3)
    assert light.numpy().tobytes() == shown.samples.tobytes()


@pytest.mark.parametrize("modulation", ["phase", "amplitude"])
@pytest.mark.parametrize("subpixels", [1, 3])
def test_gradients_of_slm_are_differences(modulation, subpixels):
    """The panel computes in float: a difference over h = 1 level has rounding 6e-8/h and an error of h**2 times the third
    derivative, (2 pi/256)**3/24 = 6e-7 of an amplitude of 1; the gradients are of about 2 pi/256 = 0.025 each."""
    panel = ht.Slm(columns=6, rows=5, pitch=8e-6, modulation=modulation)
    light = htt.Modulator(panel, "532 nm", subpixels=subpixels)
    level = (20 + 200 * torch.rand((5, 6), generator=torch.Generator().manual_seed(1), dtype=torch.float64))
    weight = samples((5 * subpixels, 6 * subpixels))

    def value(given):
        return (light(given).to(torch.complex128) * weight).real.sum()

    level.requires_grad_()
    value(level).backward()
    with torch.no_grad():
        for row, column in ((0, 0), (2, 3), (4, 5)):
            step = torch.zeros((5, 6), dtype=torch.float64)
            step[row, column] = 0.5
            difference = value(level + step) - value(level - step)
            assert float(level.grad[row, column]) == pytest.approx(float(difference), abs=2e-5 * subpixels**2)


def test_a_pixel_of_a_phase_panel_turns_its_light():
    """One panel of one pixel with fill factor 1: u = exp(i phase) times the aperture, whose gradient is i u."""
    panel = ht.Slm(columns=1, rows=1, pitch=8e-6)
    phase = torch.tensor([[1.0]], requires_grad=True)
    u = htt.Modulator(panel, "532 nm").of_phase(phase)
    u.real.sum().backward()
    assert phase.grad.item() == pytest.approx(-u.imag.item(), rel=1e-4)


def test_rounding_passes_gradients():
    level = torch.tensor([1.4, 2.6], requires_grad=True)
    rounded = htt.round_levels(level)
    rounded.sum().backward()
    assert rounded.tolist() == [1, 3] and level.grad.tolist() == [1, 1]


@pytest.mark.parametrize("eye", [{}, {"pupil": "100 um", "eye": (20e-6, -30e-6, 0.02)}], ids=["sensor", "eye"])
def test_camera_is_expose(eye):
    """The same light through the same windows, but for those of the pupil: float sums of some 1e3 terms."""
    u = samples((24, 32), torch.complex64)
    field = ht.Field(u, "8 um", "532 nm")
    seen = ht.expose(field, "10 mm", sampling="point", **eye)
    picture = htt.camera(u, "10 mm", pitch="8 um", wavelength="532 nm", **eye)
    error = np.linalg.norm(picture.numpy() - seen.pixels) / np.linalg.norm(seen.pixels)
    assert error < 1e-5


def test_gradients_of_camera_pass_gradcheck_in_double():
    u = samples((6, 8)).requires_grad_()
    for more in ({}, {"binning": 2}, {"pupil": "70 um", "eye": (0, 0, "0.3 mm")}, {"image": "real"}):
        assert torch.autograd.gradcheck(htt.Camera((6, 8), "8 um", "532 nm", "0.5 mm", **more), u)


def test_an_optimiser_finds_a_hologram():
    """A phase of 32 x 32 pixels that focuses to a bright square: Adam lowers the error of the amplitude by a factor."""
    target = torch.zeros(32, 32)
    target[12:20, 12:20] = 4.0  # 64 pixels with all the light of 1024
    space = htt.Propagation((32, 32), "8 um", "532 nm", "-5 mm")
    phase = torch.zeros(32, 32, requires_grad=True)
    optimiser = torch.optim.Adam([phase], lr=0.2)
    errors = []
    for _ in range(40):
        optimiser.zero_grad()
        loss = ((space(torch.polar(torch.ones_like(phase), phase)).abs() - target) ** 2).mean()
        loss.backward()
        optimiser.step()
        errors.append(loss.item())
    assert errors[-1] < 0.5 * errors[0]


DEVICES = ["meta"] + (["cuda"] if torch.cuda.is_available() else [])


@pytest.fixture(params=DEVICES)
def device(request, monkeypatch):
    """A device that is not the host. Without CUDA it is PyTorch's own without memory: a copy from there to the host is 3 everywhere,
    so devices, types and shapes of results and gradients are tested, but not their values."""
    if request.param == "meta":
        to_host = torch.Tensor.cpu
        monkeypatch.setattr(torch.Tensor, "cpu", lambda one: to_host(
            torch.full(one.shape, 3, dtype=one.dtype) if one.device.type == "meta" else one))
    return torch.device(request.param)


@pytest.mark.parametrize("dtype", [torch.complex64, torch.complex128])
def test_results_and_gradients_are_on_the_device_of_the_tensor(device, dtype):
    space = htt.Propagation((6, 7), "8 um", "532 nm", "0.5 mm")
    seen = htt.Camera((6, 7), "8 um", "532 nm", "0.5 mm", pupil="70 um", eye=(0, 0, "0.3 mm"), binning=2)
    for light, dtype_of_light in ((space, dtype), (space.adjoint, dtype), (seen, torch.empty(0, dtype=dtype).real.dtype)):
        u = samples((2, 6, 7), dtype).to(device).requires_grad_()
        result = light(u)
        assert (result.device.type, result.dtype) == (device.type, dtype_of_light)
        result.abs().sum().backward()
        assert (u.grad.device.type, u.grad.dtype, u.grad.shape) == (device.type, dtype, u.shape)
        if device.type != "meta":
            host = u.detach().cpu().requires_grad_()
            light(host).abs().sum().backward()
            assert torch.equal(light(u).cpu(), light(host)) and torch.allclose(u.grad.cpu(), host.grad, rtol=1e-5)


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_light_of_a_panel_is_on_the_device_of_its_levels(device, dtype):
    """The panel computes in single precision; the gradient has the precision of the levels."""
    level = torch.full((5, 6), 3, dtype=dtype, device=device).requires_grad_()
    light = htt.Modulator(ht.Slm(columns=6, rows=5, pitch=8e-6), "532 nm").of_phase(level)
    assert (light.device.type, light.dtype) == (device.type, torch.complex64)
    light.abs().sum().backward()
    assert (level.grad.device.type, level.grad.dtype) == (device.type, dtype)


def test_bad_tensors_are_refused():
    with pytest.raises(ht.Error, match="expected a complex64 or complex128 tensor, got torch.float32"):
        htt.propagate(torch.ones(3, 3), 0.1, pitch=8e-6, wavelength=5e-7)
    with pytest.raises(ht.Error, match=r"the shape \(..., rows, columns\), got \(3,\)"):
        htt.propagate(torch.ones(3), 0.1, pitch=8e-6, wavelength=5e-7)
    with pytest.raises(ht.Error, match=r"samples of the shape \(4, 4\), got \(3, 3\)"):
        htt.Propagation((4, 4), 8e-6, 5e-7, 0.01)(samples((3, 3)))
    with pytest.raises(ht.Error, match="expected levels from 0 to 256, got 300; take them modulo"):
        htt.slm(torch.full((2, 2), 300.0), ht.Slm(columns=2, rows=2, pitch=8e-6), wavelength="532 nm")
