"""A phase hologram found by an optimiser of PyTorch: any loss, network or optimiser can take the place of these."""

import torch

import holotrace as ht
import holotrace.torch as htt

panel = ht.Slm(columns=240, rows=136, pitch="8 um")
target = torch.zeros(panel.shape)
target[48:88, 60:180] = 1.0

modulator = htt.Modulator(panel, "532 nm")
camera = htt.Camera(panel.shape, panel.pitch, "532 nm", "30 mm", image="real")
torch.manual_seed(1)
phase = (6.28 * torch.rand(panel.shape)).requires_grad_()
optimiser = torch.optim.Adam([phase], lr=0.1)
for step in range(30):
    optimiser.zero_grad()
    seen = camera(modulator.of_phase(phase)).sqrt()
    scale = ((seen * target).sum() / (seen**2).sum()).detach()
    loss = ((scale * seen - target) ** 2).mean()
    loss.backward()
    optimiser.step()

hologram = ht.Hologram.from_phase(phase.detach(), panel.pitch, "532 nm", slm=panel, image="real")
hologram.save("optimised.png")
print(f"loss {loss.item():.4f}")
