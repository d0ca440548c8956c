"""A textured square made of NumPy arrays: path-traced, made into a hologram, and seen by a camera."""

import numpy as np

import holotrace as ht

row, column = np.mgrid[0:32, 0:32]
checks = np.zeros((32, 32, 3), np.float32)
checks[(row // 8 + column // 8) % 2 == 0] = (0.8, 0.7, 0.2)

square = {
    "type": "mesh",
    "vertices": np.array([[-3, -3, 0], [3, -3, 0], [3, 3, 0], [-3, 3, 0]]) * 1e-3,
    "faces": np.array([[0, 1, 2], [0, 2, 3]]),
    "uv": np.array([[0, 0], [1, 0], [1, 1], [0, 1]]),
    "material": "checks",
    "position": (0, 0, -0.1),
    "rotation": "y 30 deg",
}
scene = ht.Scene(
    wavelength="532 nm",
    slm={"preset": "pluto", "columns": 480, "rows": 270},
    materials={"checks": {"texture": checks}},
    object=[square],
    light=[{"type": "directional", "direction": [0.2, -0.3, -1], "irradiance": 3.0}],
    render={"rows": 64, "paths": 4},
    trace={"columns": 240, "rows": 240, "paths": 4},
    camera={"distances": "100 mm"},
)
ht.render(scene).save("square_render.png")
result = ht.run(scene)
result.holograms[0].save("square_hologram.png")
result.views[0].save("square_view.png", white=result.white)
print(scene, result.views[0], sep="\n")
