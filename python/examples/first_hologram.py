"""A hologram of three points at different depths, and what an eye sees that focuses on the nearest."""

import numpy as np

import holotrace as ht

points = np.array([[-1.0, 0.0, -200.0], [0.0, 0.0, -250.0], [1.0, 0.0, -300.0]]) * 1e-3  # metres, behind the panel
waves = ht.Sources(points, wavelength="532 nm")
panel = ht.Slm("pluto", columns=960, rows=540)
field = ht.synthesize(waves, panel)
hologram = ht.encode(field, panel)
hologram.save("points_hologram.png")
view = ht.expose(ht.show(hologram), "200 mm", pupil="4 mm", eye="0, 0, 250 mm")
view.save("points_view.png")
print(hologram, view, sep="\n")
