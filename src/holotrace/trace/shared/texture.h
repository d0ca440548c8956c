#pragma once

#include <algorithm>
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

/// A coordinate of a texture, brought to [0, 1].
inline double fold(double u, ImageEdge edge) {
  if (edge == ImageEdge::clamp) return std::clamp(u, 0.0, 1.0);
  const double period = edge == ImageEdge::mirror ? 2 : 1, rest = u - period * floor_of(u / period);
  return rest > 1 ? 2 - rest : rest;
}

/// Texture coordinates at the barycentric coordinates (1 − b1 − b2, b1, b2) between those of a triangle's corners.
inline Vec2 between_corners(Vec2 p, Vec2 q, Vec2 r, double b1, double b2) {
  const double b0 = 1 - b1 - b2;
  return {p.x * b0 + q.x * b1 + r.x * b2, p.y * b0 + q.y * b1 + r.y * b2};
}

/// texel(row, column) of an image between pixel centres at (u, v), bilinear or stepped. v is up: row 0 of the image is the top,
/// v = 1; beyond [0, 1] is what Image::sampling says.
template <class Texel>
auto between_texels(const Image& image, Vec2 uv, const Texel& texel) {
  const auto wrap = [](double position, int count, ImageEdge edge) {
    const int index = int(position);
    if (edge != ImageEdge::repeat) return std::clamp(index, 0, count - 1);
    return index < 0 ? index + count : index < count ? index : index - count;
  };
  const double across = fold(uv.x, image.sampling.edge_u) * image.nx,
               down = (1 - fold(uv.y, image.sampling.edge_v)) * image.ny;
  if (image.sampling.is_stepped)  // the far border, and roundings to it, are of the last pixel
    return texel(std::min(int(down), image.ny - 1), std::min(int(across), image.nx - 1));
  const double x = across - 0.5, y = down - 0.5;
  const double left = floor_of(x), top = floor_of(y), s = x - left, t = y - top;
  const int column = wrap(left, image.nx, image.sampling.edge_u),
            next_column = wrap(left + 1, image.nx, image.sampling.edge_u);
  const int row = wrap(top, image.ny, image.sampling.edge_v), next_row = wrap(top + 1, image.ny, image.sampling.edge_v);
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

/// The same at the coordinates of a mesh; white without a texture.
inline Vec3 eval_texture(const PlacedTexture& t, Vec2 first, Vec2 second) {
  if (!t.image) return {1, 1, 1};
  const auto [u, v] = t.is_second ? second : first;
  return eval_texture(*t.image, {t.uu * u + t.uv * v + t.u0, t.vu * u + t.vv * v + t.v0});
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

/// Whether a surface, or a coat on it, has normals that its mesh does not have.
inline bool has_mapped_normals(const Material& material) {
  const auto* layers = std::get_if<PrincipledMaterial>(&material.surface);
  return material.normal_map || (layers && layers->has_coat_normals);
}

/// Whether a mirror or glass acts everywhere as its mesh has it: without a normal map, and without rays that go through it.
inline bool acts_as_its_mesh(const Material& material) { return !has_mapped_normals(material) && is_opaque(material); }

}  // namespace holotrace
