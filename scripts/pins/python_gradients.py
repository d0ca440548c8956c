"""Gradients by PyTorch, as arrays."""
import numpy as np
import torch

import holotrace as ht
import holotrace.torch as htt

ht.set_threads(2)
torch.set_num_threads(1)
panel = ht.Slm(columns=32, rows=24, pitch="8 um")
phase = torch.linspace(0, 6, 32 * 24).reshape(24, 32).requires_grad_()
modulator = htt.Modulator(panel, "532 nm")
camera = htt.Camera(panel.shape, panel.pitch, "532 nm", "10 mm", image="real")
seen = camera(modulator.of_phase(phase))
seen[8:16, 8:24].sum().backward()
np.save("seen.npy", seen.detach().numpy())
np.save("gradient.npy", phase.grad.numpy())

space = htt.Propagation((12, 17), "8 um", "532 nm", "3 mm", columns=20)
light = torch.polar(torch.ones(12, 17, dtype=torch.float64), torch.linspace(0, 9, 12 * 17, dtype=torch.float64).reshape(12, 17))
there = space(light.requires_grad_())
there.abs().pow(2)[2:6].sum().backward()
np.save("there.npy", there.detach().numpy())
np.save("adjoint.npy", light.grad.numpy())
