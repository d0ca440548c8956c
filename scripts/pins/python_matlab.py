"""A field, a hologram and a picture as MATLAB's files, and back."""
import pathlib

import numpy as np

import holotrace as ht
from holotrace import interchange

waves = np.exp(0.1j * np.arange(48).reshape(6, 8))
for name, plane in {"field": ht.Field(waves, pitch="8 um", wavelength="532 nm"), "image": ht.Image(np.ones((3, 4, 3)), "5 um"),
                    "hologram": ht.Hologram(np.arange(12).reshape(3, 4), "8 um", "532 nm", levels=16)}.items():
    path = pathlib.Path(f"{name}.mat")
    interchange.save_mat(path, plane)
    path.write_bytes(b" " * 116 + path.read_bytes()[116:])  # the head has the time
    np.save(f"{name}.npy", np.asarray(interchange.load_mat(path)))
