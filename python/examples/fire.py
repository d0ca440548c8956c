"""A fire from NumPy arrays of densities and temperatures, which shines by Planck's law: path-traced."""

import numpy as np

import holotrace as ht

# Cells of a box along z, y and x. Tongues of flame sway and narrow upward; they are hot inside and cool toward their edge and tip.
z, y, x = (np.arange(n) + 0.5 for n in (24, 48, 24))
z, y, x = z[:, None, None] / 24 - 0.5, y[None, :, None] / 48, x[None, None, :] / 24 - 0.5
sway = 0.08 * np.sin(7 * y + 1) * y
distance = np.hypot(x - sway, z + 0.6 * sway) / (0.34 * (1 - y) ** 0.7 * (0.7 + 0.3 * np.cos(9 * (y + x - z))) + 1e-3)
soot = np.clip(1.15 - distance, 0, None) * np.minimum(1, 8 * y)
temperature = 1250 + 750 * np.clip(1 - distance, 0, 1) * (1 - 0.5 * y)

scene = ht.Scene(
    slm={"preset": "pluto", "columns": 480, "rows": 270},
    media={"fire": {"mean_free_path": "0.7 mm", "albedo": 0.1, "box": ["-2 -2.8 -302 mm", "2 2.8 -298 mm"], "density": soot, "temperature": temperature}},
    object=[{"type": "quad", "width": "8 mm", "height": "8 mm", "rotation": "x -90 deg", "position": "0 -2.8 -300 mm"}],
    render={"rows": 96, "paths": 32, "max_depth": 8, "field_of_view": "0.6 deg"},
)
ht.render(scene).save("fire_render.png")
print(scene)
