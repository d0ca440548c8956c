#include <algorithm>
#include <cmath>
#include <variant>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/chart.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/layers.h"
#include "holotrace/data/light_field.h"
#include "holotrace/data/scene.h"
#include "holotrace/data/sources.h"

namespace holotrace {

void check_grid(const Grid& grid) {
  require(grid.nx > 0 && grid.ny > 0, "expected a grid of at least 1 × 1 pixels, got {} × {}", grid.nx, grid.ny);
  require(std::isfinite(grid.pitch) && grid.pitch > 0, "expected a pixel pitch above 0 m, got {} m", grid.pitch);
  require(grid.pitch <= largest_pitch, "expected a pixel pitch of at most {}, got {}; give it in metres or with a unit",
          format_length(largest_pitch), format_length(grid.pitch));
}

void check_field_fits(const Grid& grid, double bytes_per_sample) {
  require_memory(double(grid.pixels()) * bytes_per_sample, fmt::format("a field of {} × {} samples", grid.nx, grid.ny));
}

void check_wavelength(double wavelength) {
  require(std::isfinite(wavelength) && wavelength > 0, "expected a wavelength above 0 m, got {} m", wavelength);
  require(wavelength <= longest_wavelength,
          "expected a wavelength of at most {}, got {}; visible light has 380 to 780 nm",
          format_length(longest_wavelength), format_length(wavelength));
}

void check_wavelength(double wavelength, const Grid& grid) {
  check_wavelength(wavelength);
  constexpr double most = 50;
  require(wavelength <= most * grid.pitch, "expected a wavelength of at most {:g} times the pitch of {}, got {}", most,
          format_length(grid.pitch), format_length(wavelength));
}

void check_cone(double cone_wavelength, double wavelength) {
  require(cone_wavelength >= 0 && cone_wavelength <= wavelength,
          "expected a cone_wavelength from 0 m to the waves' own of {}, which the panel can hold, got {}",
          format_length(wavelength), format_length(cone_wavelength));
}

namespace {

void check_second_focus(const SecondFocus& focus, Vec3 origin, size_t source) {
  const auto [place, line] = focus;
  require(
      is_finite(place) && is_finite(line) && place.z != 0,
      "expected a second focus of source {} with finite coordinates, behind the panel (z < 0) or in front of it (z > 0), got "
      "({}, {}, {}) m with the focal line ({}, {}, {})",
      source, place.x, place.y, place.z, line.x, line.y, line.z);
  const Vec3 way = place - origin;
  require(way.z != 0, "expected a second focus of source {} at another depth than its origin, got z = {} m for both",
          source, place.z);
  constexpr double rounding = 1e-6;  // of directions from files in single precision
  require(
      std::abs(length(line) - 1) < rounding && std::abs(dot(way, line)) < rounding * length(way),
      "expected the focal line of source {} as a unit vector at right angles to the way from its origin to its second focus, "
      "got ({}, {}, {})",
      source, line.x, line.y, line.z);
}

}  // namespace

void check_sources(const Sources& sources) {
  check_wavelength(sources.wavelength);
  check_cone(sources.label.cone_wavelength, sources.wavelength);
  for (size_t j = 0; j < sources.waves.size(); ++j) {
    const Source& s = sources.waves[j];
    require(is_finite(s.origin) && std::isfinite(s.amplitude) && std::isfinite(s.phase),
            "expected finite numbers in source {}, got origin ({}, {}, {}) m, amplitude {}, phase {}", j, s.origin.x,
            s.origin.y, s.origin.z, s.amplitude, s.phase);
    require(s.origin.z != 0, "expected source {} behind the panel (z < 0) or in front of it (z > 0), got z = 0 m", j);
  }
  const auto& foci = sources.second_foci;
  require(foci.empty() || foci.size() == sources.waves.size(),
          "expected a second focus for each of {} waves, or none, got {}", sources.waves.size(), foci.size());
  for (size_t j = 0; j < foci.size(); ++j)
    if (foci[j].is_astigmatic()) check_second_focus(foci[j], sources.waves[j].origin, j);
  const TileAmplitudes& tiles = sources.tiles;
  require((tiles.columns == 0 && tiles.rows == 0) || (tiles.columns > 0 && tiles.rows > 0),
          "expected amplitudes of at least 1 × 1 tiles, or of none, got {} × {}", tiles.columns, tiles.rows);
  const size_t amplitudes = size_t(tiles.columns) * size_t(tiles.rows) * sources.waves.size();
  require(tiles.values.size() == amplitudes, "expected {} amplitudes for {} × {} tiles and {} waves, got {}",
          amplitudes, tiles.columns, tiles.rows, sources.waves.size(), tiles.values.size());
  for (size_t i = 0; i < amplitudes; ++i)
    require(std::isfinite(tiles.values[i]), "expected finite amplitudes of tiles, got {} for source {} in tile {}",
            tiles.values[i], i % sources.waves.size(), i / sources.waves.size());
  require(sources.phase_keys.empty() || sources.phase_keys.size() == sources.waves.size(),
          "expected a phase key for each of {} waves, or none, got {}", sources.waves.size(),
          sources.phase_keys.size());
}

void check_sources_behind(const Sources& sources) {
  check_sources(sources);
  for (size_t j = 0; j < sources.waves.size(); ++j)
    // The length is formatted only then: there may be a million sources.
    if (!(sources.waves[j].origin.z < 0) && !is_astigmatic(sources, j))
      fail("expected source {} behind the panel (z < 0), got z = {}; synthesize sums waves from both sides", j,
           format_length(sources.waves[j].origin.z));
}

namespace {

double area(const Mesh& mesh) {
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 a = mesh.positions[i];
    sum += length(cross(mesh.positions[j] - a, mesh.positions[k] - a)) / 2;
  }
  return sum;
}

void check_mesh(const Mesh& mesh, const std::vector<Material>& materials) {
  require(!mesh.triangles.empty(), "expected triangles in mesh \"{}\", got none", mesh.name);
  require(mesh.material >= 0 && size_t(mesh.material) < materials.size(), "mesh \"{}\" has no material", mesh.name);
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3 p = mesh.positions[i];
    require(is_finite(p), "expected finite coordinates in mesh \"{}\", got ({}, {}, {}) at vertex {}", mesh.name, p.x,
            p.y, p.z, i);
  }
  const size_t count = mesh.positions.size();
  require(mesh.normals.empty() || mesh.normals.size() == count, "expected {} normals in mesh \"{}\", got {}", count,
          mesh.name, mesh.normals.size());
  for (const auto* coordinates : {&mesh.texture_coordinates, &mesh.second_coordinates})
    require(coordinates->empty() || coordinates->size() == count,
            "expected {} texture coordinates in mesh \"{}\", got {}", count, mesh.name, coordinates->size());
  require(mesh.colours.empty() || mesh.colours.size() == count, "expected {} vertex colours in mesh \"{}\", got {}",
          count, mesh.name, mesh.colours.size());
  const auto is_number = [](Vec2 v) { return std::isfinite(v.x) && std::isfinite(v.y); };
  require(std::all_of(mesh.normals.begin(), mesh.normals.end(), is_finite) &&
              std::all_of(mesh.texture_coordinates.begin(), mesh.texture_coordinates.end(), is_number) &&
              std::all_of(mesh.second_coordinates.begin(), mesh.second_coordinates.end(), is_number) &&
              std::all_of(mesh.colours.begin(), mesh.colours.end(), is_finite),
          "expected finite normals, texture coordinates and vertex colours in mesh \"{}\"", mesh.name);
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (uint32_t index : mesh.triangles[t])
      require(index < count, "expected vertex indices below {} in mesh \"{}\", got {} in triangle {}", count, mesh.name,
              index, t);
  require(max_component(materials[size_t(mesh.material)].emission) <= 0 || area(mesh) > 0,
          "expected mesh \"{}\" with some area to shine from, got none", mesh.name);
}

}  // namespace

void check_scene(const Scene& scene) {
  const bool has_visible_light = std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
    const auto* rectangle = std::get_if<RectangleLight>(&light);
    return rectangle && rectangle->is_visible;
  });
  const bool has_light_from_infinity = scene.environment || max_component(scene.background) > 0;
  require(!scene.meshes.empty() || !scene.points.empty() || has_visible_light || !scene.media.empty() ||
              has_light_from_infinity,
          "expected at least one object in the scene, a visible rectangle light, or a background, got none");
  for (const Mesh& mesh : scene.meshes) check_mesh(mesh, scene.materials);
  for (size_t i = 0; i < scene.points.size(); ++i) {
    const ScenePoint& p = scene.points[i];
    require(is_finite(p.position) && std::isfinite(p.amplitude) && std::isfinite(p.phase),
            "expected finite numbers in point {}, got position ({}, {}, {}) m, amplitude {}, phase {}", i, p.position.x,
            p.position.y, p.position.z, p.amplitude, p.phase);
    require(p.position.z != 0, "expected point {} behind the panel (z < 0) or in front of it (z > 0), got z = 0 m", i);
  }
}

namespace {

std::string name_of(const Chart& chart, size_t n) {
  const std::string& name = chart.series[n].name;
  return fmt::format("series {}{} of the chart \"{}\"", n + 1, name.empty() ? "" : " \"" + name + "\"", chart.title);
}

void check_coordinate(double value, bool is_log, const char* axis, const std::string& where) {
  require(std::isfinite(value), "expected finite {} in {}, got {}; leave out what has no value", axis, where, value);
  require(!is_log || value > 0, "expected {} above 0 in {}, whose axis is logarithmic, got {}", axis, where, value);
}

}  // namespace

void check_chart(const Chart& chart) {
  bool has_points = false;
  for (size_t n = 0; n < chart.series.size(); ++n) {
    const Series& s = chart.series[n];
    require(s.x.size() == s.y.size(), "expected as many x as y in {}, got {} and {}", name_of(chart, n), s.x.size(),
            s.y.size());
    require(s.has_line || s.has_markers, "expected a line or markers in {}, got neither", name_of(chart, n));
    for (size_t i = 0; i < s.x.size(); ++i) {
      const std::string where = fmt::format("point {} of {}", i + 1, name_of(chart, n));
      check_coordinate(s.x[i], chart.is_log_x, "x", where);
      check_coordinate(s.y[i], chart.is_log_y, "y", where);
    }
    has_points |= !s.x.empty();
  }
  require(has_points, "expected a chart with points to draw, got \"{}\" without any", chart.title);
  for (const ChartLabel& label : chart.labels) {
    const std::string where = fmt::format("the label \"{}\" of the chart \"{}\"", label.text, chart.title);
    check_coordinate(label.x, chart.is_log_x, "x", where);
    check_coordinate(label.y, chart.is_log_y, "y", where);
  }
}

namespace {

/// Pictures of radiance that belong together, in one or three channels. `name` is that of picture k in messages.
template <class Name>
void check_sizes(const std::vector<Image>& pictures, const Grid& grid, const Name& name) {
  const int channels = pictures.front().channels;
  require(channels == 1 || channels == 3, "expected 1 or 3 channels in {}, got {}", name(0), channels);
  for (size_t k = 0; k < pictures.size(); ++k) {
    const Image& picture = pictures[k];
    require(picture.nx == grid.nx && picture.ny == grid.ny && picture.channels == channels &&
                picture.values.size() == size_t(grid.pixels()) * size_t(channels),
            "expected {} x {} pixels and {} channel(s) in {}, got {} x {} and {}", grid.nx, grid.ny, channels, name(k),
            picture.nx, picture.ny, picture.channels);
  }
}

template <class Name>
void check_radiance(const std::vector<Image>& pictures, const Name& name) {
  const auto is_radiance = [](float value) { return std::isfinite(value) && value >= 0; };
  // The first value of each picture that is no radiance; 0 if all are.
  std::vector<float> strange(pictures.size(), 0);
  parallel_for(0, int64_t(strange.size()), [&](int64_t k) {
    const std::vector<float>& values = pictures[size_t(k)].values;
    const auto found = std::find_if_not(values.begin(), values.end(), is_radiance);
    if (found != values.end()) strange[size_t(k)] = *found;
  });
  for (size_t k = 0; k < strange.size(); ++k)
    require(strange[k] == 0, "expected finite radiance of 0 or more in {}, got {}", name(k), strange[k]);
}

std::string plane_name(size_t k) { return fmt::format("plane {} of the focal stack", k + 1); }

std::string view_name(const LightField& field, size_t k) {
  return fmt::format("the view of column {} and row {} of the light field", k % size_t(field.columns) + 1,
                     k / size_t(field.columns) + 1);
}

}  // namespace

void check_focal_stack(const FocalStack& stack) {
  check_grid(stack.grid);
  require(!stack.distances.empty(), "expected a focal stack of at least one plane, got none");
  require(stack.pictures.size() == stack.distances.size(),
          "expected a picture for each of the {} planes of the focal stack, got {}", stack.distances.size(),
          stack.pictures.size());
  for (size_t k = 0; k < stack.distances.size(); ++k)
    require(std::isfinite(stack.distances[k]) && stack.distances[k] != 0,
            "expected plane {} of the focal stack behind the panel or in front of it, got {}", k + 1,
            format_length(stack.distances[k]));
  check_sizes(stack.pictures, stack.grid, plane_name);
  check_radiance(stack.pictures, plane_name);
}

void check_light_field(const LightField& field) {
  check_grid(field.plane);
  require(field.columns >= 1 && field.rows >= 1 && field.views.size() == size_t(field.columns) * size_t(field.rows),
          "expected a light field with a picture for each of its {} × {} cells, got {}", field.columns, field.rows,
          field.views.size());
  const double cell = field.lens.nx > 0 ? field.cell_width() : 0;
  require(std::isfinite(cell) && cell > 0 && field.cell_height() > 0,
          "expected cells wider than 0 m in the light field, got {} m", cell);
  require(std::isfinite(field.lens_z) && field.lens_z >= 0,
          "expected the cells of the light field on the panel or in front of it, got them {} behind it",
          format_length(-field.lens_z));
  require(std::isfinite(field.distance) && field.distance + field.lens_z != 0,
          "expected a light field in a plane other than that of its lens, got one at {}",
          format_length(field.distance));
  check_sizes(field.views, field.plane, [&](size_t k) { return view_name(field, k); });
}

void check_radiance(const LightField& field) {
  check_radiance(field.views, [&](size_t k) { return view_name(field, k); });
}

namespace {

void check_slice(const Slice& slice, size_t index, const Layers& layers) {
  const Field& light = slice.light;
  check_grid(light.grid);
  require(std::isfinite(light.z), "expected slice {} at a finite place, got z = {} m", index, light.z);
  require(light.wavelength == layers.wavelength && light.grid.pitch == layers.slices.front().light.grid.pitch,
          "expected slices of one wavelength and pitch, {} and {}, got {} and {} in slice {}",
          format_length(layers.wavelength), format_length(layers.slices.front().light.grid.pitch),
          format_length(light.wavelength), format_length(light.grid.pitch), index);
  require(light.samples.nx == light.grid.nx && light.samples.ny == light.grid.ny,
          "expected {} × {} samples in slice {}, got {} × {}", light.grid.nx, light.grid.ny, index, light.samples.nx,
          light.samples.ny);
  require(slice.mask.size() == 0 || (slice.mask.nx == light.grid.nx && slice.mask.ny == light.grid.ny),
          "expected a mask of {} × {} samples in slice {}, or none, got {} × {}", light.grid.nx, light.grid.ny, index,
          slice.mask.nx, slice.mask.ny);
  for (const std::complex<float>& u : light.samples.values)
    require(std::isfinite(u.real()) && std::isfinite(u.imag()), "expected finite samples in slice {}, got {} + {}i",
            index, u.real(), u.imag());
  for (const float m : slice.mask.values)
    require(m >= 0 && m <= 1, "expected a mask in [0, 1] in slice {}, got {}", index, m);
}

}  // namespace

void check_layers(const Layers& layers) {
  check_wavelength(layers.wavelength);
  require(!layers.slices.empty(), "expected at least one slice, got none");
  for (size_t i = 0; i < layers.slices.size(); ++i) {
    check_slice(layers.slices[i], i, layers);
    require(i == 0 || layers.slices[i].depth() <= layers.slices[i - 1].depth(),
            "expected slices from far to near, got slice {} at {} after one at {}", i,
            format_length(layers.slices[i].depth()), i == 0 ? "" : format_length(layers.slices[i - 1].depth()));
  }
}

}  // namespace holotrace
