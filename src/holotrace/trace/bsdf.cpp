#include "holotrace/trace/bsdf.h"

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/trace/texture.h"

namespace holotrace {

namespace {

Vec3 clip(Vec3 v) { return {std::clamp(v.x, 0.0, 1.0), std::clamp(v.y, 0.0, 1.0), std::clamp(v.z, 0.0, 1.0)}; }

Bsdf make(const DiffuseMaterial& material, const SurfacePoint& point, const Lines& lines) {
  const Vec3 colour = material.texture ? eval_texture(*material.texture, point.uv) * point.colour : point.colour;
  DiffuseBsdf b{point.normal, point.geometric_normal, lines.from_rgb(clip(material.reflectance * colour)),
                lines.from_rgb(clip(material.transmittance * colour))};
  const double reflected = max_component(b.reflectance), transmitted = max_component(b.transmittance);
  if (transmitted > 0) b.transmission_probability = transmitted / (reflected + transmitted);
  return b;
}

template <class Other>
Bsdf make(const Other&, const SurfacePoint&, const Lines&) {
  fail("expected a diffuse material");
}

}  // namespace

Bsdf make_bsdf(const Material& material, const SurfacePoint& point, const Lines& lines) {
  return std::visit([&](const auto& surface) { return make(surface, point, lines); }, material.surface);
}

SurfacePoint shading_point(const Material&, const SurfacePoint& point) { return point; }

Vec3 emitted_radiance(const Material& material, const SurfacePoint& point, const Lines& lines) {
  if (!material.two_sided && !point.is_front) return {};
  if (!material.emission_texture) return lines.from_rgb(material.emission);
  return lines.from_rgb(material.emission * eval_texture(*material.emission_texture, point.uv));
}

MediumIndices media_at(const Material&, const SurfacePoint&, double) { return {}; }

}  // namespace holotrace
