"""Holotrace: from 3D scenes to holograms, and to what a viewer sees of them.

    import holotrace as ht

    field = ht.Field(array, pitch="8 um", wavelength="632.8 nm", z="-150 mm")
    hologram = ht.encode(ht.propagate(field, "150 mm"))

Lengths are metres, or texts with a unit; wavelengths also names of lights. Arrays have the shape (ny, nx), row 0 on top. ``ht.Error`` is what the
program reports, in the same words.
"""

from . import widgets
from ._animate import animate, save_film
from ._core import Error, __version__
from ._denoise import denoise
from ._encode import Run, encode, encode_all, load_run, run, save_panel_images
from ._fields import Field, Sources, load_field, load_fields, load_sources, save_fields
from ._figures import (
    CalibrationPlan,
    calibrate,
    calibration_patterns,
    compare,
    estimate,
    limits,
    load_calibration_plan,
    register,
)
from ._holograms import Hologram, Slm, load_hologram
from ._images import DepthImage, FocalStack, Image, LightField, load_depth_image, load_focal_stack, load_image, load_light_field
from ._lights import Light
from ._progress import ResultWarning, set_threads
from ._scenes import Scene, fields, focal_stack, load_scene, render, render_pair, trace
from ._views import Views, anaglyph, view
from ._waves import depth_image_fields, expose, propagate, show, synthesize

__all__ = [
    "CalibrationPlan",
    "DepthImage",
    "Error",
    "Field",
    "FocalStack",
    "Hologram",
    "Image",
    "Light",
    "LightField",
    "ResultWarning",
    "Run",
    "Scene",
    "Slm",
    "Sources",
    "Views",
    "__version__",
    "anaglyph",
    "animate",
    "calibrate",
    "calibration_patterns",
    "compare",
    "denoise",
    "depth_image_fields",
    "encode",
    "encode_all",
    "estimate",
    "expose",
    "fields",
    "focal_stack",
    "limits",
    "load_calibration_plan",
    "load_depth_image",
    "load_field",
    "load_fields",
    "load_focal_stack",
    "load_hologram",
    "load_image",
    "load_light_field",
    "load_run",
    "load_scene",
    "load_sources",
    "propagate",
    "register",
    "render",
    "render_pair",
    "run",
    "save_fields",
    "save_film",
    "save_panel_images",
    "set_threads",
    "show",
    "synthesize",
    "trace",
    "view",
    "widgets",
]
