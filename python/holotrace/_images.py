"""Image, DepthImage, FocalStack and LightField."""

from __future__ import annotations

import os
from typing import Any, List, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core, _picture
from ._arrays import array_of, is_array, real_numbers, rows_and_columns
from ._checked import count, items, number
from ._fields import Path
from ._noun import ArrayNoun, Noun
from ._units import Length, Lengths, format_length


class Image(ArrayNoun):
    """A picture of linear light, row 0 on top: [W/m2] on a sensor, [W/m2/sr] from ``render``.

    ``np.asarray(image)`` and ``torch.from_dlpack(image)`` are the memory of the image, not a copy.

    Parameters
    ----------
    pixels : array of the shape (rows, columns) or (rows, columns, 3)
        Linear light, not sRGB codes. 8- and 16-bit pictures are read from files, by ``load_image``.
    pitch : length
        Side of a pixel; 0 if it is unknown.
    """

    __slots__ = ()

    def __init__(self, pixels: Any, pitch: Length = 0.0) -> None:
        given = array_of(pixels, "an image")
        if given.dtype.kind != "f":
            floats = "np.abs(array)**2" if given.dtype.kind == "c" else "array.astype(float)"
            raise _core.Error(
                f"expected floating-point linear light for an image, got {given.dtype}; give {floats}, or read a picture file,"
                " whose codes are not linear, with ht.load_image(path)"
            )
        if given.ndim not in (2, 3):
            raise _core.Error(
                f"expected an image of the shape (rows, columns) or (rows, columns, 3), got {given.shape}"
            )
        array = real_numbers(given, "an image")
        self._core = _core.Image.make(array[:, :, None] if array.ndim == 2 else array, pitch)
        self.facts = {}

    @property
    def pixels(self) -> np.ndarray[Any, Any]:
        """Linear light of the shape (rows, columns) or (rows, columns, 3), a view of the image's memory."""
        array: np.ndarray[Any, Any] = self._core.pixels
        return array

    @property
    def _values(self) -> np.ndarray[Any, Any]:
        return self.pixels

    @property
    def shape(self) -> Tuple[int, ...]:
        shape: Tuple[int, ...] = self.pixels.shape
        return shape

    @property
    def channels(self) -> int:
        """1, or 3 for red, green and blue."""
        return int(self._core.channels)

    @property
    def pitch(self) -> float:
        """Side of a pixel [m]; 0 if it is unknown."""
        return float(self._core.pitch)

    @property
    def white(self) -> float:
        """The value that is shown as white, by the rule of views (docs/explanation/viewing.md)."""
        return float(_core.common_white([self._core], 0.0))

    def save(self, path: Path, *, white: float = 0.0, bits: int = 8) -> None:
        """Write .png or .jpg (sRGB; ``white`` is the value shown as white, 0: by the rule of views) or .exr (linear)."""
        self._core.save(os.fspath(path), number(white, "white"), count(bits, "bits"))

    def __repr__(self) -> str:
        rows, columns = self.shape[:2]
        colours = ", colour" if self.channels == 3 else ""
        pitch = f", pitch={format_length(self.pitch)}" if self.pitch > 0 else ""
        return f"Image({columns} x {rows}{colours}{pitch})"

    def page(self, white: float) -> str:
        """The picture as HTML for a notebook."""
        return _picture.page(repr(self), [("", _picture.grey(_picture.reduced(self.pixels), white))])

    def _repr_html_(self) -> str:
        return self.page(self.white)


def load_image(path: Path) -> Image:
    """The picture of a file as linear light: sRGB codes are decoded, EXR values are as they are."""
    return Image._of(_core.load_image(os.fspath(path)))


class DepthImage(Noun):
    """A picture and the depth of each of its pixels (RGB-D).

    Parameters
    ----------
    picture : Image, or array of the shape (rows, columns) or (rows, columns, 3)
        Linear light; 1 is white.
    depth : array of the shape (rows, columns)
        Depths behind the panel, below 0 in front of it [m]; 0: nothing there.
    """

    __slots__ = ()

    def __init__(self, picture: Union[Image, Any], depth: Any) -> None:
        image = picture if isinstance(picture, Image) else Image(picture)
        metres = rows_and_columns(real_numbers(depth, "depths"), "depths")
        self._core = _core.DepthImage.make(image._core, metres)
        self.facts = {}

    @property
    def picture(self) -> Image:
        return Image._of(self._core.picture)

    @property
    def depth(self) -> np.ndarray[Any, Any]:
        """Depths of the shape (rows, columns) [m], a view of the memory."""
        array: np.ndarray[Any, Any] = self._core.depth
        return array

    def __repr__(self) -> str:
        rows, columns = self.depth.shape
        there = self.depth[self.depth != 0]
        depths = f"{format_length(float(there.min()))} to {format_length(float(there.max()))}" if there.size else "none"
        return f"DepthImage({columns} x {rows}, depths {depths})"

    def _repr_html_(self) -> str:
        picture, depth = self.picture, _picture.reduced(self.depth)
        there = depth[depth != 0] if depth.any() else np.zeros(1)
        range_of_depths = max(float(there.max() - there.min()), 1e-30)
        nearness = np.where(depth == 0, 0, 1 - 0.8 * (depth - there.min()) / range_of_depths)
        return _picture.page(
            repr(self),
            [
                ("picture", _picture.grey(_picture.reduced(picture.pixels), 1.0)),
                ("depth", (255 * nearness).astype(np.uint8)),
            ],
        )


def load_depth_image(
    picture: Path, depth: Path, *, near: Optional[Length] = None, far: Optional[Length] = None, depth_scale: str = "depth"
) -> DepthImage:
    """A picture with depths from two files.

    A depth file of 8 or 16 bits is grey: ``near`` is the depth of white, ``far`` that of black. Between them the depth
    is in equal steps of grey, or with ``depth_scale="disparity"`` its inverse. An EXR has metres. Depths are behind the
    panel, below 0 in front of it.
    """
    if (near is None) != (far is None):
        raise _core.Error("expected both near and far, the depths of white and black, or neither for an EXR; give both")
    near, far = (0.0, 0.0) if near is None or far is None else (near, far)
    return DepthImage._of(_core.DepthImage.load(os.fspath(picture), os.fspath(depth), near, far, depth_scale))


class FocalStack(ArrayNoun):
    """Pictures of one scene, each with another plane in focus. Planes are behind the panel, or in front of it at negative distances.

    ``np.asarray(stack)`` is a copy of the shape (planes, rows, columns[, 3]), because each picture has memory of its own.

    Parameters
    ----------
    pictures : sequence of Image, or array of the shape (planes, rows, columns[, 3])
        Linear radiance [W/m2/sr].
    distances : lengths
        Distances of the planes from the panel, one for each picture.
    pitch : length
        Pixel pitch, which is the panel's.
    """

    __slots__ = ()

    def __init__(self, pictures: Union[Sequence[Image], Any], distances: Lengths, pitch: Length) -> None:
        if is_array(pictures):
            pictures = array_of(pictures, "the pictures of a focal stack")  # from its device at once
        images = [one if isinstance(one, Image) else Image(one) for one in items(pictures, "the pictures of a focal stack")]
        self._core = _core.FocalStack.make([image._core for image in images], distances, pitch)
        self.facts = {}

    @property
    def pictures(self) -> List[Image]:
        return [Image._of(core) for core in self._core.pictures]

    @property
    def _values(self) -> np.ndarray[Any, Any]:
        array: np.ndarray[Any, Any] = np.stack([core.pixels for core in self._core.pictures])
        return array

    @property
    def distances(self) -> List[float]:
        """[m]"""
        return list(self._core.distances)

    @property
    def pitch(self) -> float:
        """[m]"""
        return float(self._core.pitch)

    def save(self, path: Path) -> None:
        """Write .h5."""
        self._core.save(os.fspath(path))

    def __repr__(self) -> str:
        rows, columns = self._core.pictures[0].pixels.shape[:2]
        planes = ", ".join(format_length(one) for one in self.distances)
        return f"FocalStack({columns} x {rows}, planes at {planes})"

    def _repr_html_(self) -> str:
        white = float(_core.common_white(self._core.pictures, 0.0))
        return _picture.page(
            repr(self),
            [
                (format_length(distance), _picture.grey(_picture.reduced(core.pixels), white))
                for distance, core in zip(self.distances, self._core.pictures)
            ],
        )


def load_focal_stack(path: Path, *, allow_outside: bool = False) -> FocalStack:
    """The focal stack of an .h5 file."""
    return FocalStack._of(_core.load_focal_stack(os.fspath(path), allow_outside))


class LightField(ArrayNoun):
    """Pictures of one scene from places side by side, such as photographs by an array of cameras. All show one plane, pixel by pixel.

    ``np.asarray(light_field)`` is a copy of the shape (rows, columns, pixel rows, pixel columns[, 3]).

    Parameters
    ----------
    views : array of the shape (rows, columns, pixel rows, pixel columns[, 3])
        Linear radiance [W/m2/sr] of each cell's view; the first row is the upper one. A view is what is seen from the middle of its cell:
        its pixels are in the common plane, so that what lies there is at the same pixel in all views.
    cell : length
        Distance from one cell to the next, along both axes. The cells are centred on the panel's axis.
    pitch : length
        Pixel pitch in the common plane.
    distance : length
        Distance of that plane behind the panel.
    lens_z : length
        Place of the cells: on the panel (0), or so far in front of it, such as where eyes look from.
    """

    __slots__ = ()

    def __init__(self, views: Any, cell: Length, pitch: Length, distance: Length, lens_z: Length = 0.0) -> None:
        array = array_of(views, "the views of a light field")
        if array.ndim not in (4, 5):
            raise _core.Error(
                "expected views of the shape (rows, columns, pixel rows, pixel columns) or (rows, columns, pixel rows, pixel columns, 3), "
                f"got {array.shape}"
            )
        images = [Image(view)._core for row in array for view in row]
        self._core = _core.LightField.make(images, array.shape[1], cell, pitch, distance, lens_z)
        self.facts = {}

    @property
    def _values(self) -> np.ndarray[Any, Any]:
        core = self._core
        array: np.ndarray[Any, Any] = np.stack([view.pixels for view in core.views])
        return array.reshape((core.rows, core.columns) + array.shape[1:])

    @property
    def cell(self) -> float:
        """[m]"""
        return float(self._core.cell)

    @property
    def lens_z(self) -> float:
        """[m]"""
        return float(self._core.lens_z)

    @property
    def pitch(self) -> float:
        """[m]"""
        return float(self._core.pitch)

    @property
    def distance(self) -> float:
        """[m]"""
        return float(self._core.distance)

    def save(self, path: Path) -> None:
        """Write .h5."""
        self._core.save(os.fspath(path))

    def __repr__(self) -> str:
        rows, columns = self._core.views[0].pixels.shape[:2]
        return (
            f"LightField({self._core.columns} x {self._core.rows} views of {columns} x {rows}, {format_length(self.cell)} apart, "
            f"plane at {format_length(self.distance)})"
        )

    def _repr_html_(self) -> str:
        core = self._core
        first, middle, last = 0, len(core.views) // 2, len(core.views) - 1
        white = float(_core.common_white(core.views, 0.0))
        pictures = [
            (f"row {k // core.columns + 1}, column {k % core.columns + 1}", _picture.grey(_picture.reduced(core.views[k].pixels), white))
            for k in sorted({first, middle, last})
        ]
        return _picture.page(repr(self), pictures)


def load_light_field(path: Path, *, allow_outside: bool = False) -> LightField:
    """The light field of an .h5 file."""
    return LightField._of(_core.load_light_field(os.fspath(path), allow_outside))
