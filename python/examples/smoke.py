"""A column of smoke from a NumPy array of densities, lit from the side: path-traced."""

import numpy as np

import holotrace as ht

# Cells of a box along z, y and x; the column widens upward and sways, and lumps of three sizes break it up.
z, y, x = (np.arange(n) + 0.5 for n in (32, 64, 32))
z, y, x = z[:, None, None] / 32 - 0.5, y[None, :, None] / 64, x[None, None, :] / 32 - 0.5
distance = np.hypot(x - 0.12 * np.sin(9 * y), z - 0.12 * np.cos(7 * y)) / (0.10 + 0.22 * y)
lumps = sum(np.sin(k * (2 * x + y) + 3 * k) * np.sin(k * (3 * y - z)) * np.sin(k * (2 * z + x)) / k**0.5 for k in (11, 23, 47))
density = np.clip(1.2 - distance + 0.5 * lumps, 0, None) * (1 - y)

scene = ht.Scene(
    wavelength="532 nm",
    background=0.1,
    slm={"preset": "pluto", "columns": 480, "rows": 270},
    media={"smoke": {"mean_free_path": "0.7 mm", "albedo": 0.9, "box": ["-2 -3 -302 mm", "2 3 -298 mm"], "density": density}},
    light=[{"type": "directional", "direction": [-1, -0.3, -0.2], "irradiance": 8.0}],
    render={"rows": 64, "paths": 8, "max_depth": 32, "field_of_view": "0.6 deg"},
)
ht.render(scene).save("smoke_render.png")
print(scene)
