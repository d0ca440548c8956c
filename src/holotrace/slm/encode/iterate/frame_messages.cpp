#include "holotrace/slm/encode/iterate/frame_messages.h"

#include <memory>

#include "holotrace/base/pack.h"

namespace holotrace {
namespace {

using Map = std::shared_ptr<const Array2D<float>>;

void pack_map(std::string& bytes, const Map& map) { pack(bytes, map ? *map : Array2D<float>()); }

Map get_map(Unpacker& unpacker) {
  Array2D<float> map;
  unpacker.get(map);
  return map.size() > 0 ? std::make_shared<const Array2D<float>>(std::move(map)) : nullptr;
}

// All members by name: one that is added does not compile here.
void pack_effects(std::string& bytes, const SlmEffects& effects) {
  const auto& [calibration, crosstalk, gap_amplitude, gap_phase, flicker, aberration, phase_map, light_map,
               dead_fraction, dead_seed, dead_pixels] = effects;
  pack(bytes, calibration);
  for (const double value : {crosstalk, gap_amplitude, gap_phase, flicker}) pack(bytes, value);
  pack(bytes, aberration);
  pack_map(bytes, phase_map);
  pack_map(bytes, light_map);
  pack(bytes, dead_fraction);
  pack(bytes, dead_seed);
  pack(bytes, dead_pixels);
}

void get_effects(Unpacker& unpacker, SlmEffects& effects) {
  unpacker.get(effects.calibration);
  for (double* value : {&effects.crosstalk, &effects.gap_amplitude, &effects.gap_phase, &effects.flicker})
    unpacker.get(*value);
  unpacker.get(effects.aberration);
  effects.phase_map = get_map(unpacker);
  effects.light_map = get_map(unpacker);
  unpacker.get(effects.dead_fraction);
  unpacker.get(effects.dead_seed);
  unpacker.get(effects.dead_pixels);
}

// Names are left out.
void pack_slm(std::string& bytes, const Slm& slm) {
  const auto& [name, grid, modulation, levels, fill_factor, fill_x, fill_y, design_wavelength, phase_range, effects,
               preset, source, own_effects] = slm;
  pack(bytes, grid);
  pack(bytes, modulation);
  pack(bytes, levels);
  for (const double value : {fill_factor, fill_x, fill_y, design_wavelength, phase_range}) pack(bytes, value);
  pack_effects(bytes, effects);
}

void get_slm(Unpacker& unpacker, Slm& slm) {
  unpacker.get(slm.grid);
  unpacker.get(slm.modulation);
  unpacker.get(slm.levels);
  for (double* value : {&slm.fill_factor, &slm.fill_x, &slm.fill_y, &slm.design_wavelength, &slm.phase_range})
    unpacker.get(*value);
  get_effects(unpacker, slm.effects);
}

// Call visit(part) for all that is sent of the parameters, of a frame, and of views, in one order for both ways.
template <class Params, class Visit>
void visit_params(Params& params, const Visit& visit) {
  visit(params.method);
  visit(params.stop);
  visit(params.subpixels);
  visit(params.planes_per_update);
  visit(params.device);
}

template <class Frame, class Visit>
void visit_frame(Frame& frame, const Visit& visit) {
  visit(frame.grid);
  visit(frame.levels);
  visit(frame.modulation);
  visit(frame.wavelength);
  visit(frame.level);
  visit(frame.modulus_level);
}

template <class Views, class Visit>
void visit_views(Views& views, const Visit& visit) {
  visit(views.z);
  visit(views.wavelength);
  visit(views.window);
  visit(views.picture);
  visit(views.pupils);
}

auto packs_into(std::string& bytes) {
  return [&bytes](const auto& part) { pack(bytes, part); };
}
auto gets_from(Unpacker& unpacker) {
  return [&unpacker](auto& part) { unpacker.get(part); };
}

}  // namespace

std::string pack_job(const FrameJob& job) {
  std::string bytes;
  pack_slm(bytes, job.slm);
  visit_params(job.params, packs_into(bytes));
  pack(bytes, uint64_t(job.frames_of_all));
  pack(bytes, uint64_t(job.frames.size()));
  return bytes;
}

FrameJob unpack_job(const std::string& bytes) {
  FrameJob job;
  Unpacker unpacker(bytes);
  get_slm(unpacker, job.slm);
  visit_params(job.params, gets_from(unpacker));
  uint64_t frames_of_all = 0, frames = 0;
  unpacker.get(frames_of_all);
  unpacker.get(frames);
  job.frames_of_all = frames_of_all;
  job.frames.resize(frames);
  return job;
}

std::string pack_frame(const Hologram& frame) {
  std::string bytes;
  visit_frame(frame, packs_into(bytes));
  return bytes;
}

void unpack_frame(const std::string& bytes, Hologram& frame) {
  Unpacker unpacker(bytes);
  visit_frame(frame, gets_from(unpacker));
}

std::string pack_views(const ViewTargets& views) {
  std::string bytes;
  visit_views(views, packs_into(bytes));
  for (const Array2D<float>& amplitude : views.amplitudes) pack(bytes, amplitude);
  return bytes;
}

ViewTargets unpack_views(const std::string& bytes) {
  ViewTargets views;
  Unpacker unpacker(bytes);
  visit_views(views, gets_from(unpacker));
  for (size_t k = 0; k < views.pupils.size(); ++k) unpacker.get(views.amplitudes.emplace_back());
  return views;
}

}  // namespace holotrace
