#include "holotrace/data/job.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/archive.h"
#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/units.h"
#include "holotrace/data/members.h"
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
  bool operator()(const PrincipledMaterial& m) const {
    const bool is_film = m.iridescence.value > 0;  // thin films show colours of their own
    bool is_any = is_film || is_coloured(m.attenuation_color);
    for (const TexturedColour* colour :
         {&m.base_color, &m.specular_color, &m.diffuse_transmission_color, &m.sheen_color})
      is_any = is_any || is_coloured(colour->value) || is_coloured(colour->texture.image);
    return is_any;
  }
  bool operator()(const ScatteringMaterial& m) const {
    return is_coloured(m.albedo) || m.droplet_radius > 0 || m.blackbody > 0;
  }
  bool operator()(const MeasuredMaterial&) const { return true; }
  bool operator()(const FilterMaterial&) const { return false; }
};

struct LightColour {
  bool operator()(const PointLight& light) const { return light.spectrum || is_coloured(light.intensity); }
  bool operator()(const SpotLight& light) const { return light.spectrum || is_coloured(light.intensity); }
  bool operator()(const DirectionalLight& light) const { return light.spectrum || is_coloured(light.irradiance); }
  bool operator()(const RectangleLight& light) const { return light.spectrum || is_coloured(light.radiance); }
};

}  // namespace

bool has_colours(const Scene& scene) {
  const auto any = [](const auto& list, const auto& test) { return std::any_of(list.begin(), list.end(), test); };
  return is_coloured(scene.background) ||
         (scene.environment &&
          (scene.environment->sky || is_coloured(scene.environment->scale) || is_coloured(scene.environment->map))) ||
         any(scene.lights, [](const Light& light) { return std::visit(LightColour(), light); }) ||
         any(scene.media, [](const Medium& medium) { return is_coloured(medium.extinction); }) ||
         any(scene.materials,
             [](const Material& m) {
               return std::visit(SurfaceColour(), m.surface) || is_coloured(m.emission) || m.emission_spectrum ||
                      is_coloured(m.emission_texture);
             }) ||
         any(scene.meshes,
             [&](const Mesh& mesh) { return any(mesh.colours, [](Vec3 colour) { return is_coloured(colour); }); });
}

bool has_light(const Scene& scene) {
  const auto emits = [](const Material& material) {
    const auto* particles = std::get_if<ScatteringMaterial>(&material.surface);
    return length(material.emission) > 0 || (particles && particles->blackbody > 0);
  };
  return !scene.lights.empty() || !scene.points.empty() || scene.environment || length(scene.background) > 0 ||
         std::any_of(scene.materials.begin(), scene.materials.end(), emits);
}

namespace {

std::vector<double> wavelengths_for(bool has_colours) {
  using namespace literals;
  return has_colours ? std::vector{638_nm, 532_nm, 450_nm} : std::vector{532_nm};
}

}  // namespace

std::vector<double> wavelengths_for(const Scene& scene) { return wavelengths_for(has_colours(scene)); }

void choose_wavelengths(Job& job) { choose_wavelengths(job, has_colours(job.scene)); }

void choose_wavelengths(Job& job, bool has_colours) {
  job.wavelengths = wavelengths_for(has_colours);
  std::string shown;
  for (const double wavelength : job.wavelengths) shown += (shown.empty() ? "" : ", ") + format_length(wavelength);
  job.chosen.push_back({"wavelength", shown, has_colours ? "the scene has colours" : "the scene is grey"});
}

void set_wavelengths(std::vector<double> wavelengths, Job& job) {
  job.wavelengths = std::move(wavelengths);
  std::erase_if(job.chosen, [](const auto& choice) { return choice.parameter == "wavelength"; });
}

Shutter parse_shutter(std::string_view text) {
  Shutter shutter;
  const bool is_angle = text.ends_with("deg") || text.ends_with("rad");
  try {
    (is_angle ? shutter.angle : shutter.seconds) = is_angle ? parse_angle(text) : parse_time(text);
  } catch (const Error&) {
    fail("expected a time or an angle with its unit, such as \"20 ms\" or \"180 deg\", got \"{}\"", text);
  }
  require(shutter.seconds >= 0 && shutter.angle >= 0, "expected a shutter of 0 s or more, got \"{}\"", text);
  return shutter;
}

std::optional<double> last_change(const Job& job) {
  if (!job.tracked) return job.last_key;
  return std::max(job.last_key.value_or(job.tracked->end), job.tracked->end);
}

namespace {

bool are_equal(const MeasuredBrdf& a, const MeasuredBrdf& b) {
  return std::equal(a.fields.begin(), a.fields.end(), b.fields.begin(), b.fields.end(),
                    [](const MeasuredField& own, const MeasuredField& other) { return own.values == other.values; });
}

// Lets a picture be the one of another scene if both are equal.
void share(std::shared_ptr<const Image>& picture, const std::shared_ptr<const Image>& other) {
  if (picture && other && picture->nx == other->nx && picture->ny == other->ny &&
      picture->channels == other->channels && picture->sampling == other->sampling && picture->values == other->values)
    picture = other;
}

// The same for all pictures of a scene. Those of the surfaces of materials are in the same places if nothing else changes.
void share_pictures(Scene& scene, const Scene& other) {
  for (size_t i = 0; i < std::min(scene.materials.size(), other.materials.size()); ++i) {
    Material& own = scene.materials[i];
    const Material& with = other.materials[i];
    share(own.emission_texture, with.emission_texture);
    share(own.normal_map, with.normal_map);
    share(own.opacity_texture, with.opacity_texture);
    if (auto* surface = std::get_if<DiffuseMaterial>(&own.surface))
      if (const auto* of_other = std::get_if<DiffuseMaterial>(&with.surface))
        share(surface->texture, of_other->texture);
    if (auto* surface = std::get_if<MetallicRoughnessMaterial>(&own.surface))
      if (const auto* of_other = std::get_if<MetallicRoughnessMaterial>(&with.surface)) {
        share(surface->base_texture, of_other->base_texture);
        share(surface->metallic_texture, of_other->metallic_texture);
      }
    if (auto* surface = std::get_if<MeasuredMaterial>(&own.surface))
      if (const auto* of_other = std::get_if<MeasuredMaterial>(&with.surface))
        if (are_equal(*surface->brdf, *of_other->brdf)) surface->brdf = of_other->brdf;
    if (auto* surface = std::get_if<PrincipledMaterial>(&own.surface))
      if (const auto* of_other = std::get_if<PrincipledMaterial>(&with.surface)) {
        std::vector<const PlacedTexture*> others;
        for_each_texture(*of_other, [&](const PlacedTexture& texture) { others.push_back(&texture); });
        auto next = others.begin();
        for_each_texture(*surface, [&](PlacedTexture& texture) { share(texture.image, (*next++)->image); });
      }
  }
  if (scene.environment && other.environment) share(scene.environment->map, other.environment->map);
  for (size_t i = 0; i < std::min(scene.media.size(), other.media.size()); ++i)
    for (Cells Medium::*cells : {&Medium::density, &Medium::temperature})
      share((scene.media[i].*cells).values, (other.media[i].*cells).values);
}

double bytes_of(const Scene& scene) {
  double bytes = 0;
  for (const Mesh& mesh : scene.meshes)
    bytes += double(mesh.positions.size() * sizeof(Vec3) + mesh.normals.size() * sizeof(Vec3) +
                    mesh.colours.size() * sizeof(Vec3) +
                    (mesh.texture_coordinates.size() + mesh.second_coordinates.size()) * sizeof(Vec2) +
                    mesh.triangles.size() * sizeof(mesh.triangles[0]));
  return bytes;  // tables and pictures that rest are shared (share_pictures)
}

}  // namespace

Job open_shutter(Job job, double seconds, const std::function<Job(double time)>& at) {
  require(seconds >= 0 && std::isfinite(seconds), "expected a shutter of 0 s or more, got {:g} s", seconds);
  if (seconds == 0 || !last_change(job)) return job;
  require_memory(shutter_moments * bytes_of(job.scene), "the scenes of an open shutter");
  const uint64_t opened = fingerprint_of(job.scene);
  uint64_t before = 0;
  bool is_moving = false;
  std::vector<Moment> moments;
  for (int k = 0; k < shutter_moments; ++k) {
    Job now = at(job.time + (k + 0.5) / shutter_moments * seconds);
    const uint64_t found = fingerprint_of(now.scene);
    is_moving = is_moving || found != opened || !(now.render.eye == job.render.eye);
    share_pictures(now.scene, job.scene);
    moments.push_back({k > 0 && found == before ? moments.back().scene : std::make_shared<Scene>(std::move(now.scene)),
                       now.render.eye - job.render.eye});
    before = found;
  }
  if (is_moving) job.moments = std::move(moments);
  return job;
}

SceneExposure exposure_of(const Job& job) {
  return job.moments.empty() ? SceneExposure(job.scene) : SceneExposure(job.moments);
}

}  // namespace holotrace
