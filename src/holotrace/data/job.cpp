#include "holotrace/data/job.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/data/spectrum.h"

namespace holotrace {
namespace {

bool is_coloured(float red, float green, float blue) {
  const auto [least, most] = std::minmax({red, green, blue});
  return most - least > 0.03F * most;
}

bool is_coloured(Vec3 colour) { return is_coloured(float(colour.x), float(colour.y), float(colour.z)); }

bool is_coloured(const std::shared_ptr<const Image>& texture) {
  if (!texture || texture->channels < 3) return false;
  const auto channels = size_t(texture->channels);
  // One pixel in 1000 may be anything: pictures of grey things, as JPEG keeps them, have some coloured pixels.
  size_t coloured = 0;
  for (size_t i = 0; i + 2 < texture->values.size(); i += channels)
    coloured += is_coloured(texture->values[i], texture->values[i + 1], texture->values[i + 2]) ? 1 : 0;
  return 1000 * coloured > texture->values.size() / channels;
}

// Reflectance at normal incidence, |(n − 1)/(n + 1)|².
bool is_coloured(const RefractiveIndex& metal) {
  const auto reflectance = [&](double wavelength) {
    const std::complex<double> n = index_at(metal, wavelength);
    return std::norm((n - 1.0) / (n + 1.0));
  };
  // Silver and steel differ by up to a tenth between red and blue, and look grey.
  return std::abs(reflectance(red_line) - reflectance(blue_line)) > 0.2;
}

struct SurfaceColour {
  bool operator()(const DiffuseMaterial& m) const {
    return is_coloured(m.reflectance) || is_coloured(m.transmittance) || is_coloured(m.texture);
  }
  bool operator()(const ConductorMaterial& m) const { return is_coloured(m.index); }
  bool operator()(const DielectricMaterial&) const { return false; }
  bool operator()(const MetallicRoughnessMaterial& m) const {
    return is_coloured(m.base_color) || is_coloured(m.base_texture);
  }
};

struct LightColour {
  bool operator()(const PointLight& light) const { return is_coloured(light.intensity); }
  bool operator()(const SpotLight& light) const { return is_coloured(light.intensity); }
  bool operator()(const DirectionalLight& light) const { return is_coloured(light.irradiance); }
  bool operator()(const RectangleLight& light) const { return is_coloured(light.radiance); }
};

}  // namespace

bool has_colours(const Scene& scene) {
  const auto any = [](const auto& list, const auto& test) { return std::any_of(list.begin(), list.end(), test); };
  return is_coloured(scene.background) ||
         (scene.environment && (is_coloured(scene.environment->scale) || is_coloured(scene.environment->map))) ||
         any(scene.lights, [](const Light& light) { return std::visit(LightColour(), light); }) ||
         any(scene.materials,
             [](const Material& m) {
               return std::visit(SurfaceColour(), m.surface) || is_coloured(m.emission) ||
                      is_coloured(m.emission_texture);
             }) ||
         any(scene.meshes,
             [&](const Mesh& mesh) { return any(mesh.colours, [](Vec3 colour) { return is_coloured(colour); }); });
}

bool has_light(const Scene& scene) {
  const auto emits = [](const Material& material) { return length(material.emission) > 0; };
  return !scene.lights.empty() || !scene.points.empty() || scene.environment || length(scene.background) > 0 ||
         std::any_of(scene.materials.begin(), scene.materials.end(), emits);
}

std::vector<double> wavelengths_for(const Scene& scene) {
  using namespace literals;
  if (has_colours(scene)) return {638_nm, 532_nm, 450_nm};
  return {532_nm};
}

void choose_wavelengths(Job& job) {
  job.wavelengths = wavelengths_for(job.scene);
  std::string shown;
  for (const double wavelength : job.wavelengths) shown += (shown.empty() ? "" : ", ") + format_length(wavelength);
  job.chosen.push_back(
      {"wavelength", shown, job.wavelengths.size() > 1 ? "the scene has colours" : "the scene is grey"});
}

void set_wavelengths(std::vector<double> wavelengths, Job& job) {
  job.wavelengths = std::move(wavelengths);
  std::erase_if(job.chosen, [](const auto& choice) { return choice.parameter == "wavelength"; });
}

}  // namespace holotrace
