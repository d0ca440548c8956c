#pragma once

#include <initializer_list>
#include <string>
#include <type_traits>
#include <vector>

#include "holotrace/base/archive.h"
#include "holotrace/data/calibration.h"
#include "holotrace/data/depth_image.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/image.h"
#include "holotrace/data/job.h"
#include "holotrace/data/light_field.h"
#include "holotrace/data/report.h"
#include "holotrace/data/sources.h"
#include "holotrace/data/target.h"

// The members of each noun, for the archives of base/archive.h, and their keys in the metadata of files, in SI units. Types of plain memory
// need no list but for keys. Structured bindings make a list that lacks a member fail to compile.

namespace holotrace {

template <class Archive>
void members(Archive& archive, Label& part) {
  auto& [name, frame, cone] = part;
  archive(key_if_set("name", name), key_if_set("frame", frame), key_if_set("cone_wavelength_m", cone));
}

template <class Archive>
void members(Archive& archive, Grid& part) {
  auto& [nx, ny, pitch, centre_x, centre_y] = part;
  archive(nx, ny, required_key("pitch_m", pitch), key_if_set("centre_x_m", centre_x),
          key_if_set("centre_y_m", centre_y));
}

template <class Archive>
void members(Archive& archive, SpectralFilter& part) {
  auto& [u0, v0, half_u, half_v] = part;
  archive(required_key("half_u_per_m", half_u), required_key("half_v_per_m", half_v), required_key("u0_per_m", u0),
          required_key("v0_per_m", v0));
}

// The file of a stack of fields has the wavelengths of all.
template <class Archive, class Real>
void members(Archive& archive, BasicField<Real>& noun) {
  auto& [grid, wavelength, z, samples, image, filter, label] = noun;
  archive(keys_of(grid), required_key("wavelengths_m", wavelength), key("z_m", z), key("image", image), keys_of(label),
          key_if_set("filter", filter), samples);
}

template <class Archive>
void members(Archive& archive, Image& noun) {
  auto& [nx, ny, channels, pitch, centre_x, centre_y, sampling, values] = noun;
  archive(nx, ny, channels, pitch, centre_x, centre_y, sampling, values);
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
  archive(keys_of(grid), required_key("distances_m", distances), pictures);
}

// The cells of a file are squares.
template <class Archive>
void members(Archive& archive, LightField& noun) {
  auto& [panel, lens, lens_z, columns, rows, plane, distance, views] = noun;
  archive(panel.nx, panel.ny, panel.pitch, panel.centre_x, panel.centre_y, lens.nx, lens.ny,
          required_key("cell_m", lens.pitch), key_if_set("lens_x_m", lens.centre_x),
          key_if_set("lens_y_m", lens.centre_y), key("lens_z_m", lens_z), columns, rows, keys_of(plane),
          required_key("distance_m", distance), views);
}

template <class Archive>
void members(Archive& archive, DepthImage& noun) {
  auto& [picture, depth] = noun;
  archive(picture, depth);
}

template <class Archive>
void members(Archive& archive, ZernikeTerm& part) {
  auto& [n, m, rms] = part;
  archive(required_key("n", n), required_key("m", m), required_key("rms_rad", rms));
}

template <class Archive>
void members(Archive& archive, WavePlate& part) {
  auto& [axis, delay] = part;
  archive(required_key("axis_rad", axis), required_key("delay_rad", delay));
}

template <class Archive>
void members(Archive& archive, Crystal& part) {
  auto& [pass, director, twist, delays, polariser, analyser, before, behind] = part;
  archive(required_key("pass", pass), key_if_set("director_rad", director), key_if_set("twist_rad", twist),
          key_if_set("delays_rad", delays), key("polariser_rad", polariser, polariser.has_value()),
          key("analyser_rad", analyser, analyser.has_value()), key_if_set("plates_before", before),
          key_if_set("plates_behind", behind));
}

template <class Archive>
void members(Archive& archive, SlmEffects& noun) {
  auto& [calibration, crosstalk, gap_amplitude, gap_phase, flicker, aberration, phase_map, light_map, dead_fraction,
         dead_seed, dead_pixels, crystal] = noun;
  archive(key_if_set("crosstalk_pixels", crosstalk), key_if_set("gap_amplitude", gap_amplitude),
          key_if_set("gap_phase_rad", gap_phase), key_if_set("flicker", flicker), key_if_set("aberration", aberration),
          key_if_set("dead_fraction", dead_fraction), key("dead_seed", dead_seed, dead_fraction > 0),
          key_if_set("dead_pixels", dead_pixels), key_if_set("calibration", calibration),
          key("crystal", crystal, crystal.has_value()), phase_map, light_map);
}

template <class Archive>
void members(Archive& archive, Slm& noun) {
  auto& [name, grid, modulation, levels, fill, fill_x, fill_y, design, range, effects, preset, source, own] = noun;
  archive(key("name", name), key("modulation", modulation), required_key("levels", levels),
          required_key("fill_factor", fill), required_key("design_wavelength_m", design), key("phase_range_rad", range),
          key("fill_x", fill_x, fill_x > 0), key("fill_y", fill_y, fill_x > 0), key_if_set("panel", preset),
          key_if_set("source", source), key("effects", effects), key_if_set("own_effects", own), grid);
}

template <class Archive>
void members(Archive& archive, ViewingConditions& noun) {
  auto& [distances, pupil, eye, follows_eye] = noun;
  archive(required_key("distances_m", distances), key_if_set("pupil_m", pupil), key("eye_m", eye, pupil > 0),
          key_if_set("view_follows_eye", follows_eye));
}

template <class Archive>
void members(Archive& archive, JointColour& part) {
  auto& [wavelength, illumination] = part;
  archive(required_key("wavelength_m", wavelength), required_key("illumination_w_per_m2", illumination));
}

template <class Archive>
void members(Archive& archive, Hologram& noun) {
  auto& [grid, level, levels, modulation, wavelength, image, filter, encoder, slm, illumination, colours, label, losses,
         modulus_level, effects, viewing] = noun;
  archive(keys_of(grid), required_key("wavelength_m", wavelength), key("levels", levels), key("modulation", modulation),
          key("image", image), key("encoder", encoder), key("illumination_w_per_m2", illumination),
          key_if_set("colours", colours), keys_of(label), key("loses_by", losses, losses != LightLosses{}),
          key_if_set("effects", effects), key("slm", slm, slm.has_value()), key_if_set("filter", filter),
          key("viewing", viewing, viewing.are_known()), level, modulus_level);
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
void members(Archive& archive, Spectrum& part) {
  auto& [wavelengths, values] = part;
  archive(wavelengths, values);
}
template <class Archive>
void members(Archive& archive, MeasuredField& part) {
  auto& [name, shape, values] = part;
  archive(name, shape, values);
}
template <class Archive>
void members(Archive& archive, MeasuredBrdf& part) {
  auto& [fields, alpha, diffuse_share] = part;
  archive(fields, alpha, diffuse_share);
}
template <class Archive>
void members(Archive& archive, MeasuredMaterial& part) {
  auto& [brdf] = part;
  archive(brdf);
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
void members(Archive& archive, PlacedTexture& part) {
  auto& [image, uu, uv, u0, vu, vv, v0, is_second] = part;
  archive(image, uu, uv, u0, vu, vv, v0, is_second);
}
template <class Archive>
void members(Archive& archive, TexturedNumber& part) {
  auto& [value, texture] = part;
  archive(value, texture);
}
template <class Archive>
void members(Archive& archive, TexturedColour& part) {
  auto& [value, texture] = part;
  archive(value, texture);
}
template <class Archive>
void members(Archive& archive, PrincipledMaterial& part) {
  auto& [base_color, metalness, roughness, index, specular, specular_color, anisotropy, anisotropy_rotation,
         anisotropy_direction, transmission, is_thin, attenuation_color, attenuation_distance, diffuse_transmission,
         diffuse_transmission_color, clearcoat, clearcoat_roughness, clearcoat_index, has_coat_normals,
         clearcoat_normals, clearcoat_normal_scale, sheen_color, sheen_roughness, iridescence, iridescence_index,
         film_thickness, least_thickness, thickness_texture] = part;
  archive(base_color, metalness, roughness, index, specular, specular_color, anisotropy, anisotropy_rotation,
          anisotropy_direction, transmission, is_thin, attenuation_color, attenuation_distance, diffuse_transmission,
          diffuse_transmission_color, clearcoat, clearcoat_roughness, clearcoat_index, has_coat_normals,
          clearcoat_normals, clearcoat_normal_scale, sheen_color, sheen_roughness, iridescence, iridescence_index,
          film_thickness, least_thickness, thickness_texture);
}
template <class Archive>
void members(Archive& archive, ScatteringMaterial& part) {
  auto& [albedo, anisotropy, droplet_radius, blackbody] = part;
  archive(albedo, anisotropy, droplet_radius, blackbody);
}
template <class Archive>
void members(Archive& archive, FilterMaterial& part) {
  auto& [axis, transmittance, leakage, delay, path_difference] = part;
  archive(axis, transmittance, leakage, delay, path_difference);
}
template <class Archive>
void members(Archive& archive, Material& part) {
  auto& [surface, emission, emission_texture, emission_spectrum, normal_map, normal_scale, opacity, opacity_texture,
         opacity_cutoff, two_sided, medium] = part;
  archive(surface, emission, emission_texture, emission_spectrum, normal_map, normal_scale, opacity, opacity_texture,
          opacity_cutoff, two_sided, medium);
}
template <class Archive>
void members(Archive& archive, MediumBox& part) {
  auto& [low, high] = part;
  archive(low, high);
}
template <class Archive>
void members(Archive& archive, Cells& part) {
  auto& [values, planes] = part;
  archive(values, planes);
}
template <class Archive>
void members(Archive& archive, Medium& part) {
  auto& [name, extinction, material, is_open, box, density, temperature] = part;
  archive(name, extinction, material, is_open, box, density, temperature);
}
template <class Archive>
void members(Archive& archive, Mesh& part) {
  auto& [name, positions, normals, texture_coordinates, second_coordinates, colours, triangles, material] = part;
  archive(name, positions, normals, texture_coordinates, second_coordinates, colours, triangles, material);
}
template <class Archive>
void members(Archive& archive, PointLight& part) {
  auto& [position, intensity, is_laser, spectrum] = part;
  archive(position, intensity, is_laser, spectrum);
}
template <class Archive>
void members(Archive& archive, SpotLight& part) {
  auto& [position, direction, intensity, inner_angle, outer_angle, spectrum] = part;
  archive(position, direction, intensity, inner_angle, outer_angle, spectrum);
}
template <class Archive>
void members(Archive& archive, DirectionalLight& part) {
  auto& [direction, irradiance, position, radius, is_laser, spectrum] = part;
  archive(direction, irradiance, position, radius, is_laser, spectrum);
}
template <class Archive>
void members(Archive& archive, RectangleLight& part) {
  auto& [corner, edge_u, edge_v, radiance, is_visible, spectrum] = part;
  archive(corner, edge_u, edge_v, radiance, is_visible, spectrum);
}
template <class Archive>
void members(Archive& archive, Sky& part) {
  auto& [turbidity, elevation, azimuth, has_sun] = part;
  archive(turbidity, elevation, azimuth, has_sun);
}
template <class Archive>
void members(Archive& archive, Environment& part) {
  auto& [map, scale, turn, sky] = part;
  archive(map, scale, turn, sky);
}
template <class Archive>
void members(Archive& archive, Scene& part) {
  auto& [materials, meshes, lights, points, background, environment, media, reflectances, analyser] = part;
  archive(materials, meshes, lights, points, background, environment, media, reflectances, analyser);
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
void members(Archive& archive, Moment& part) {
  auto& [scene, eye_moved] = part;
  archive(scene, eye_moved);
}
template <class Archive>
void members(Archive& archive, TrackedEye& part) {
  auto& [place, measured, unpredicted, end] = part;
  archive(place, measured, unpredicted, end);
}
template <class Archive>
void members(Archive& archive, Job& noun) {
  auto& [scene, wavelengths, slm, trace, render, synthesize, encode, show, propagate, camera, animate, eye, tracked,
         time, shutter, moments, last_key, are_distances_given, warnings, chosen] = noun;
  archive(scene, wavelengths, slm, trace, render, synthesize, encode, show, propagate, camera, animate, eye, tracked,
          time, shutter, moments, last_key, are_distances_given, warnings, chosen);
}

// Of results.

template <class Archive>
void members(Archive& archive, StageReport& part) {
  auto& [stage, seconds, facts, warnings, curves] = part;
  archive(stage, seconds, facts, warnings, curves);
}
template <class Archive>
void members(Archive& archive, Report& part) {
  auto& [seed, stages, chosen, time] = part;
  archive(seed, stages, chosen, time);
}

}  // namespace holotrace
