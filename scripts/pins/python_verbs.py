"""The verbs and nouns of the Python package: python_verbs.py INPUTS, whose results become files, pickles and arrays."""
import json
import pathlib
import pickle
import sys

import numpy as np

import holotrace as ht

INPUTS = pathlib.Path(sys.argv[1])
texts = {}


def keep(name, noun):
    """Writes the pickle of a noun, its array, and what it says of itself; returns what the pickle holds."""
    pickled = pickle.dumps(noun, protocol=4)
    if not isinstance(noun, (ht.Run, ht.Views)):  # their reports have times
        pathlib.Path(f"{name}.pickle").write_bytes(pickled)
        texts[name] = {"repr": repr(noun), "facts": noun.facts, "bytes of the pickle": len(pickled)}
    if hasattr(noun, "__array__"):
        np.save(f"{name}.npy", np.asarray(noun))
    return pickle.loads(pickled)


ht.set_threads(2)
rng = np.random.default_rng(2)
places = np.column_stack([rng.uniform(-4e-4, 4e-4, (20, 2)), rng.uniform(-0.04, -0.03, 20)])
panel = keep("slm", ht.Slm(str(INPUTS / "effects.toml")))
sources = keep("sources", ht.Sources(places, rng.uniform(0.5, 1, 20), rng.uniform(0, 6, 20), wavelength=532e-9))
sources.save("sources.ply")
field = keep("field", ht.synthesize(sources, panel, method="tiled"))
field.save("field.h5")
keep("double", ht.propagate(ht.Field(np.asarray(field).astype(complex), field.pitch, field.wavelength), 0.01))
keep("moved", ht.propagate(field, "-30 mm", centre_x="80 um", columns=100))
hologram = keep("hologram", ht.encode(field, panel, method="phase"))
hologram.save("hologram.png")
keep("iterated", ht.encode(field, panel, method="sgd", target_distances=[0.03], iterations=4))
keep("shown", ht.show(hologram, subpixels=3, effects="all"))
keep("exposed", ht.expose(ht.show(hologram), "30 mm", pupil="1 mm", eye="0, 0, 40 mm"))
views = keep("views", ht.view(hologram, distances="30 mm, 32 mm", eye_separation="2 mm", pupil="1 mm", eye="0 0 40 mm",
                              sweep="focus", sweep_views=2, sweep_from="30 mm", sweep_to="31 mm"))
views.save("views.png")
keep("anaglyph", ht.anaglyph(*views.stereo))

scene = keep("scene", ht.load_scene(INPUTS / "room.toml"))
keep("render", ht.render(scene, paths=2)).save("render.exr")
for name, image in zip(("left", "right"), ht.render_pair(scene, "4 mm", eye="0 0 60 mm", paths=1)):
    keep(name, image)
stack = keep("stack", ht.focal_stack(scene, "29 31 mm", paths=2))
stack.save("stack.h5")
for i, one in enumerate(ht.encode_all(stack, panel, wavelength="532 nm", frames=2, iterations=3)):
    keep(f"frame_{i}", one)
keep("traced", ht.trace(scene, phase="path")[0])
keep("light", ht.fields(scene)[0])
triangle = {"type": "mesh", "vertices": np.array([[-1, -1, 0], [1, -1, 0], [0, 1, 0.5]]) * 1e-3, "faces": [[0, 1, 2]],
            "position": (0, 0, -0.03)}
made = keep("made", ht.Scene(wavelength="532 nm", slm={"columns": 64, "rows": 48}, object=[triangle],
                             light=[{"type": "point", "position": (0, 0, -0.01), "intensity": 1e-3}],
                             render={"rows": 32, "paths": 2, "denoise": "none"}, trace={"columns": 16, "rows": 12, "paths": 2}))
run = keep("run", ht.run(made, camera={"distances": "30 mm"}))
run.save("run")
depths = ht.DepthImage(rng.uniform(0, 1, (12, 16, 3)), np.linspace(0.03, 0.04, 192).reshape(12, 16))
keep("depths", depths)
keep("of_depths", ht.depth_image_fields(depths, panel, wavelength="532 nm", synthesize={"slices": 3})[0])
assumed = ht.Slm(str(INPUTS / "assumed.toml"))
plan = keep("plan", ht.calibration_patterns(assumed, wavelength="633 nm", distance="50 mm", level_patterns=2))
plan.save("plan")
texts["limits"] = ht.limits(panel, wavelength="532 nm", distance="300 mm")
texts["compare"] = ht.compare(ht.load_image("render.exr"), ht.render(scene, paths=1))
pathlib.Path("texts.json").write_text(json.dumps(texts, indent=1, default=repr) + "\n")
