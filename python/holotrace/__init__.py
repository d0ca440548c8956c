"""Holotrace: from 3D scenes to holograms, and to what a viewer sees of them.

    import holotrace as ht

    field = ht.Field(array, pitch="8 um", wavelength="632.8 nm")
    hologram = ht.encode(ht.propagate(field, "-150 mm"))

Lengths are metres, or texts with a unit. Arrays have the shape (ny, nx), row 0 on top. ``ht.Error`` is what the
program reports, in the same words.
"""

from ._core import Error, __version__, set_threads
from ._encode import Run, encode, encode_all, run
from ._fields import Field, Sources, load_field, load_fields, load_sources, save_fields
from ._figures import (
    CalibrationPlan,
    calibrate,
    calibration_patterns,
    compare,
    estimate,
    limits,
    load_calibration_plan,
)
from ._holograms import Hologram, Slm, load_hologram
from ._images import FocalStack, Image, load_focal_stack, load_image
from ._progress import ResultWarning
from ._scenes import Scene, fields, focal_stack, load_scene, render, trace
from ._waves import expose, propagate, show, synthesize

__all__ = [
    "CalibrationPlan",
    "Error",
    "Field",
    "FocalStack",
    "Hologram",
    "Image",
    "ResultWarning",
    "Run",
    "Scene",
    "Slm",
    "Sources",
    "__version__",
    "calibrate",
    "calibration_patterns",
    "compare",
    "encode",
    "encode_all",
    "estimate",
    "expose",
    "fields",
    "focal_stack",
    "limits",
    "load_calibration_plan",
    "load_field",
    "load_fields",
    "load_focal_stack",
    "load_hologram",
    "load_image",
    "load_scene",
    "load_sources",
    "propagate",
    "render",
    "run",
    "save_fields",
    "set_threads",
    "show",
    "synthesize",
    "trace",
]
