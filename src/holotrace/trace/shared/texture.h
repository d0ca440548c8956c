#pragma once

#include <cmath>
#include <cstdint>
#include <variant>

#include "holotrace/base/vec.h"
#include "holotrace/data/image.h"
#include "holotrace/data/rgl_brdf.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// The largest whole number that is not above a number: std::floor, which is a call where processors need not have SSE 4.
inline double floor_of(double number) {
  if (!(std::abs(number) < 1e15)) return std::floor(number);
  const auto whole = double(int64_t(number));
  return whole > number ? whole - 1 : whole;
}

/// texel(row, column) of an image between pixel centres at (u, v), bilinear. v is up: row 0 of the image is the top, v = 1; beyond
/// [0, 1] the image repeats.
template <class Texel>
auto between_texels(const Image& image, Vec2 uv, const Texel& texel) {
  const auto wrap = [](double position, int count) {
    const int index = int(position);
    return index < 0 ? index + count : index < count ? index : index - count;
  };
  const double x = (uv.x - floor_of(uv.x)) * image.nx - 0.5, y = (1 - (uv.y - floor_of(uv.y))) * image.ny - 0.5;
  const double left = floor_of(x), top = floor_of(y), s = x - left, t = y - top;
  const int column = wrap(left, image.nx), next_column = wrap(left + 1, image.nx);
  const int row = wrap(top, image.ny), next_row = wrap(top + 1, image.ny);
  return (texel(row, column) * (1 - s) + texel(row, next_column) * s) * (1 - t) +
         (texel(next_row, column) * (1 - s) + texel(next_row, next_column) * s) * t;
}

/// Colour of a texture at (u, v) (between_texels). One channel gives grey.
inline Vec3 eval_texture(const Image& image, Vec2 uv) {
  return between_texels(image, uv, [&](int row, int column) -> Vec3 {
    if (image.channels < 3) return Vec3{1, 1, 1} * double(image(row, column));
    return {image(row, column, 0), image(row, column, 1), image(row, column, 2)};
  });
}

/// The part of the rays that a material stops at (u, v), from 0 to 1.
inline double opacity_at(const Material& material, Vec2 uv) {
  double opacity = material.opacity;
  if (const Image* texture = material.opacity_texture.get())
    opacity *= between_texels(*texture, uv, [&](int row, int column) { return double((*texture)(row, column)); });
  return material.opacity_cutoff > 0 ? double(opacity >= material.opacity_cutoff) : opacity;
}

/// Whether a material stops all rays.
inline bool is_opaque(const Material& material) { return !material.opacity_texture && opacity_at(material, {}) >= 1; }

/// Whether a surface reflects differently along its tangents.
inline bool is_brushed(const Material& material) {
  if (const auto* measured = std::get_if<MeasuredMaterial>(&material.surface)) return is_brushed(*measured->brdf);
  const auto* layers = std::get_if<PrincipledMaterial>(&material.surface);
  return layers && layers->anisotropy.value > 0;
}

/// Whether a mirror or glass acts everywhere as its mesh has it: without a normal map, and without rays that go through it.
inline bool acts_as_its_mesh(const Material& material) { return !material.normal_map && is_opaque(material); }

}  // namespace holotrace
