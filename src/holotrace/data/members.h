#pragma once

#include <initializer_list>
#include <string>
#include <type_traits>
#include <vector>

#include "holotrace/data/calibration.h"
#include "holotrace/data/depth_image.h"
#include "holotrace/data/field.h"
#include "holotrace/data/focal_stack.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/image.h"
#include "holotrace/data/job.h"
#include "holotrace/data/report.h"
#include "holotrace/data/sources.h"
#include "holotrace/data/target.h"

// The members of each noun, for the archives of base/archive.h. Types of plain memory need no list. Structured bindings make a list that
// lacks a member fail to compile.

namespace holotrace {

template <class Archive>
void members(Archive& archive, Label& part) {
  auto& [name, frame, cone] = part;
  archive(name, frame, cone);
}

template <class Archive, class Real>
void members(Archive& archive, BasicField<Real>& noun) {
  auto& [grid, wavelength, z, samples, image, filter, label] = noun;
  archive(grid, wavelength, z, samples, image, filter, label);
}

template <class Archive>
void members(Archive& archive, Image& noun) {
  auto& [nx, ny, channels, pitch, centre_x, centre_y, values] = noun;
  archive(nx, ny, channels, pitch, centre_x, centre_y, values);
}

template <class Archive>
void members(Archive& archive, TileAmplitudes& noun) {
  auto& [columns, rows, values] = noun;
  archive(columns, rows, values);
}

template <class Archive>
void members(Archive& archive, Sources& noun) {
  auto& [wavelength, waves, tiles, foci, label, keys, seed] = noun;
  archive(wavelength, waves, tiles, foci, label, keys, seed);
}

template <class Archive>
void members(Archive& archive, FocalStack& noun) {
  auto& [grid, distances, pictures] = noun;
  archive(grid, distances, pictures);
}

template <class Archive>
void members(Archive& archive, DepthImage& noun) {
  auto& [picture, depth] = noun;
  archive(picture, depth);
}

template <class Archive>
void members(Archive& archive, SlmEffects& noun) {
  auto& [calibration, crosstalk, gap_amplitude, gap_phase, flicker, aberration, phase_map, light_map, dead_fraction,
         dead_seed, dead_pixels] = noun;
  archive(calibration, crosstalk, gap_amplitude, gap_phase, flicker, aberration, phase_map, light_map, dead_fraction,
          dead_seed, dead_pixels);
}

template <class Archive>
void members(Archive& archive, Slm& noun) {
  auto& [name, grid, modulation, levels, fill, fill_x, fill_y, design, range, effects, preset, source, own] = noun;
  archive(name, grid, modulation, levels, fill, fill_x, fill_y, design, range, effects, preset, source, own);
}

template <class Archive>
void members(Archive& archive, ViewingConditions& noun) {
  auto& [distances, pupil, eye] = noun;
  archive(distances, pupil, eye);
}

template <class Archive>
void members(Archive& archive, Hologram& noun) {
  auto& [grid, level, levels, modulation, wavelength, image, filter, encoder, slm, illumination, colours, label,
         by_cone, by_pixels, modulus_level, effects, viewing] = noun;
  archive(grid, level, levels, modulation, wavelength, image, filter, encoder, slm, illumination, colours, label,
          by_cone, by_pixels, modulus_level, effects, viewing);
}

template <class Archive>
void members(Archive& archive, TestPattern& noun) {
  auto& [name, kind, hologram] = noun;
  archive(name, kind, hologram);
}

template <class Archive>
void members(Archive& archive, CalibrationPlan& noun) {
  auto& [distance, patterns] = noun;
  archive(distance, patterns);
}

// Of targets.

template <class Archive>
void members(Archive& archive, TargetPlane& part) {
  auto& [z, wavelength, amplitude, weight] = part;
  archive(z, wavelength, amplitude, weight);
}
template <class Archive>
void members(Archive& archive, ViewTargets& part) {
  auto& [z, wavelength, window, picture, pupils, amplitudes] = part;
  archive(z, wavelength, window, picture, pupils, amplitudes);
}

// Of a scene.

template <class Archive>
void members(Archive& archive, RefractiveIndex& part) {
  archive(part.samples);
}
template <class Archive>
void members(Archive& archive, DiffuseMaterial& part) {
  auto& [reflectance, texture, transmittance] = part;
  archive(reflectance, texture, transmittance);
}
template <class Archive>
void members(Archive& archive, ConductorMaterial& part) {
  auto& [index, roughness] = part;
  archive(index, roughness);
}
template <class Archive>
void members(Archive& archive, DielectricMaterial& part) {
  auto& [index, roughness, is_thin] = part;
  archive(index, roughness, is_thin);
}
template <class Archive>
void members(Archive& archive, MetallicRoughnessMaterial& part) {
  auto& [base_color, base_texture, metallic, roughness, metallic_texture] = part;
  archive(base_color, base_texture, metallic, roughness, metallic_texture);
}
template <class Archive>
void members(Archive& archive, Material& part) {
  auto& [surface, emission, emission_texture, normal_map, normal_scale, two_sided] = part;
  archive(surface, emission, emission_texture, normal_map, normal_scale, two_sided);
}
template <class Archive>
void members(Archive& archive, Mesh& part) {
  auto& [name, positions, normals, texture_coordinates, colours, triangles, material] = part;
  archive(name, positions, normals, texture_coordinates, colours, triangles, material);
}
template <class Archive>
void members(Archive& archive, Environment& part) {
  auto& [map, scale, turn] = part;
  archive(map, scale, turn);
}
template <class Archive>
void members(Archive& archive, Scene& part) {
  auto& [materials, meshes, lights, points, background, environment] = part;
  archive(materials, meshes, lights, points, background, environment);
}

/// A visitor of `describe` that passes on each parameter.
template <class Archive>
struct ParamMembers {
  Archive& archive;

  void operator()(const auto& parameter) { archive(parameter.value); }
};

/// The parameters of a stage, which `describe` lists.
template <class Archive, class Params>
requires requires(ParamMembers<Archive>& visitor, Params& params) { describe(visitor, params); }
void members(Archive& archive, Params& params) {
  ParamMembers<Archive> visitor{archive};
  describe(visitor, params);
}

template <class Archive>
void members(Archive& archive, Chosen& part) {
  auto& [parameter, value, why] = part;
  archive(parameter, value, why);
}
template <class Archive>
void members(Archive& archive, Job& noun) {
  auto& [scene, wavelengths, slm, trace, render, synthesize, encode, show, propagate, camera, are_distances_given,
         warnings, chosen] = noun;
  archive(scene, wavelengths, slm, trace, render, synthesize, encode, show, propagate, camera, are_distances_given,
          warnings, chosen);
}

// Of results.

template <class Archive>
void members(Archive& archive, StageReport& part) {
  auto& [stage, seconds, facts, warnings, curves] = part;
  archive(stage, seconds, facts, warnings, curves);
}
template <class Archive>
void members(Archive& archive, Report& part) {
  auto& [seed, stages, chosen] = part;
  archive(seed, stages, chosen);
}

}  // namespace holotrace
