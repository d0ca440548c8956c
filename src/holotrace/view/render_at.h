#pragma once

#include "holotrace/data/image.h"
#include "holotrace/data/view_place.h"

namespace holotrace {

/// The pixels of a view, without light, in the plane in focus.
Image sensor_at(const ViewPlace& place, int rows, int columns);

/// A render as a view of rows × columns pixels should show it: in the colours of the view's light (seen_at), each pixel
/// the mean over its area (project_render).
/// @param render  radiance of 1 or 3 channels
/// @return        one channel for one wavelength, otherwise three
Image render_at(const Image& render, const ViewPlace& place, int rows, int columns);

/// A picture that shows the same window as another, on its pixels: each the mean over its area.
/// @throws Error  unless the ratios of width to height agree to half a pixel
Image on_pixels_of(const Image& picture, const Image& other);

/// A colour picture as grey, by its luminance 0.2126·R + 0.7152·G + 0.0722·B (ITU-R BT.709, linear light). A grey picture
/// is not changed.
Image luminance_of(const Image& image);

}  // namespace holotrace
