#include "holotrace/calibrate/fit_panel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/calibrate/least_squares.h"
#include "holotrace/calibrate/measured_panel.h"
#include "holotrace/calibrate/patterns.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/view/register/register.h"

namespace holotrace {
namespace {

constexpr size_t least_levels = 3;
constexpr double least_correlation = 0.5;  // of a photograph that shows its pattern, before the last fit
constexpr double last_tolerance = 1e-5;    // of the fit of all unknowns
constexpr double curvature_reach = 6, curvature_step = 0.4;  // of the search [rad rms]

void check_inputs(const CalibrationPlan& plan, const std::vector<Image>& photographs) {
  require(!plan.patterns.empty(), "expected a plan with test patterns, got none");
  require(plan.patterns.size() == photographs.size(), "expected a photograph for each of {} patterns, got {}",
          plan.patterns.size(), photographs.size());
  std::set<int> levels;
  bool has_spots = false;
  for (size_t i = 0; i < photographs.size(); ++i) {
    const TestPattern& pattern = plan.patterns[i];
    const Hologram& first = plan.patterns.front().hologram;
    require(pattern.hologram.slm.has_value(),
            "{}: expected a pattern with the panel it was made for, got none; write "
            "the patterns again",
            pattern.name);
    require(
        pattern.hologram.grid == first.grid && pattern.hologram.wavelength == first.wavelength &&
            pattern.hologram.levels == first.levels && pattern.hologram.modulation == Modulation::phase,
        "{}: expected a phase pattern for the same panel and wavelength as {}, got another; write the patterns again",
        pattern.name, plan.patterns.front().name);
    require(
        photographs[i].nx == photographs.front().nx && photographs[i].ny == photographs.front().ny,
        "{}: expected a photograph of {} × {} pixels, as that of {}, got {} × {}; take all with one camera that does "
        "not move, and do not crop them",
        pattern.name, photographs.front().nx, photographs.front().ny, plan.patterns.front().name, photographs[i].nx,
        photographs[i].ny);
    has_spots |= pattern.kind == PatternKind::spots;
    for (const uint16_t level : pattern.hologram.level.values) levels.insert(level);
  }
  require(has_spots,
          "expected a pattern of the kind \"spots\", which shows where the camera is, got none; write the "
          "patterns again");
  require(levels.size() >= least_levels,
          "expected patterns with at least {} levels, got {}; write patterns with more "
          "measured levels",
          least_levels, levels.size());
}

Channel channel_of(const Image& photograph, bool is_mirrored) {
  Channel channel = mean_of_channels(photograph);
  if (is_mirrored)
    for (int j = 0; j < channel.ny; ++j) std::reverse(&channel(j, 0), &channel(j, 0) + channel.nx);
  return channel;
}

// The largest value of pictures of one size, each of the same brightness, squared: the spots of all of them. Registration
// compares the roots of two pictures, and so the light itself; its roots would give the light between the spots, which
// depends on what is not known yet, too much weight.
Image largest_of(const std::vector<Channel>& channels) {
  Image image(channels.front().ny, channels.front().nx, 1);
  for (const Channel& channel : channels) {
    const double sum = std::accumulate(channel.values.begin(), channel.values.end(), 0.0);
    if (sum <= 0) continue;
    const float scale = float(double(channel.values.size()) / sum);
    for (size_t i = 0; i < channel.values.size(); ++i)
      image.values[i] = std::max(image.values[i], std::pow(scale * std::max(0.0F, channel.values[i]), 2.0F));
  }
  return image;
}

// From places in the photograph (u right, v down) to places in the window.
Similarity camera_of(const Registration& r) {
  const double c = std::cos(r.rotation) / r.scale, s = std::sin(r.rotation) / r.scale;
  // In (u, v) the registration is q = scale·R(−rotation)·p + (shift_x, −shift_y); this is its inverse.
  return {c, s, -(c * r.shift_x - s * -r.shift_y), -(s * r.shift_x + c * -r.shift_y)};
}

class PanelSearch {
 public:
  PanelSearch(const CalibrationPlan& plan, const CalibrateParams& params, const Observer& observer)
      : plan_(plan),
        params_(params),
        observer_(observer),
        bench_(make_basis(plan.patterns, params), plan.distance),
        unknowns_(first_guess(bench_.basis(), *plan.patterns.front().hologram.slm, plan.patterns.size())) {}

  PanelFit find(const std::vector<Image>& photographs) {
    place_camera(photographs);
    search_curve();
    search_curvature();
    const FitResult result = fit_all();
    PanelFit fit = measured_panel(bench_, *plan_.patterns.front().hologram.slm, unknowns_, result);
    fit.photographs = explained(result);
    return fit;
  }

 private:
  std::vector<Exposure> of_kind(PatternKind kind) const {
    std::vector<Exposure> chosen;
    for (const Exposure& exposure : exposures_)
      if (plan_.patterns[exposure.number].kind == kind) chosen.push_back(exposure);
    return chosen;
  }

  void add(std::vector<Unknown>& free, UnknownKind kind, size_t count, size_t first = 0) const {
    for (size_t k = first; k < count; ++k) free.push_back({kind, k});
  }

  // Camera, light and wavefront; the curvature only if `whole`, since spots alone do not tell it from the camera's scale.
  std::vector<Unknown> optics(bool whole) const {
    std::vector<Unknown> free;
    add(free, UnknownKind::camera, 4);
    add(free, UnknownKind::light, unknowns_.light.size());
    for (size_t k = 0; k < unknowns_.aberration.size(); ++k)
      if (whole || bench_.basis().aberration[k].m != 0 || bench_.basis().aberration[k].n != 2)
        free.push_back({UnknownKind::aberration, k});
    return free;
  }

  std::vector<Unknown> everything() const {
    std::vector<Unknown> free = optics(true);
    add(free, UnknownKind::blur, 1);
    add(free, UnknownKind::phase, unknowns_.phases.size(), 1);
    add(free, UnknownKind::amplitude, unknowns_.amplitude.size());
    add(free, UnknownKind::crosstalk, 1);
    add(free, UnknownKind::gap, 2);
    return free;
  }

  // Each pattern has its spots at other places: together they have one pose only.
  void place_camera(const std::vector<Image>& photographs) {
    std::vector<Channel> seen, expected;
    for (size_t i = 0; i < photographs.size(); ++i) {
      seen.push_back(channel_of(photographs[i], params_.is_mirrored));
      expected.push_back(bench_.irradiance(plan_.patterns[i].hologram, unknowns_));
    }
    try {
      unknowns_.camera = camera_of(register_image(largest_of(seen), largest_of(expected)));
    } catch (const Error&) {
      fail(
          "expected photographs that show the spots of their patterns at {} from the panel, got some in which these are not found; "
          "check the distance, that there is no lens before the sensor, and whether the photographs are mirror images (mirrored)",
          format_length(plan_.distance));
    }
    for (size_t i = 0; i < photographs.size(); ++i)
      exposures_.push_back({&plan_.patterns[i].hologram,
                            choose_pixels(channel_of(photographs[i], params_.is_mirrored), unknowns_.camera,
                                          bench_.window(), params_.samples, plan_.patterns[i].name),
                            i});
    const std::vector<Exposure> spots = of_kind(PatternKind::spots);
    misfit_of(bench_, spots, unknowns_);
    fit(bench_, spots, optics(false), FitEffort{}, unknowns_, part_of(observer_, 0, 10));
  }

  // The best start for the phases among scaled and bent copies of the assumed curve.
  void search_curve() {
    const std::vector<Exposure> all = of_kind(PatternKind::levels);
    if (all.empty()) return;
    const std::vector<Exposure> some(all.begin(), all.begin() + std::ptrdiff_t(std::min<size_t>(all.size(), 3)));
    const std::vector<double> assumed = unknowns_.phases;
    const double last = assumed.back();
    require(last > 0,
            "expected an assumed panel whose phase grows with the level, got {} rad at its last level; give it a "
            "phase_range above 0, or another calibration",
            last);
    double best = std::numeric_limits<double>::infinity();
    std::vector<double> chosen = assumed;
    const std::vector<double> bends{1, 0.8, 1.25, 0.64, 1.56};
    const int steps = 12;  // by 12 % each: 0.35 rad from the nearest at 2π, well within the reach of the fit
    for (size_t b = 0; b < bends.size(); ++b)
      for (int k = 0; k <= steps; ++k) {
        const double scale = 0.5 * std::pow(4.0, double(k) / steps);  // 0.5 … 2
        for (size_t i = 0; i < assumed.size(); ++i)
          unknowns_.phases[i] = scale * last * std::pow(std::max(0.0, assumed[i] / last), bends[b]);
        const double cost = misfit_of(bench_, some, unknowns_).of_one();
        if (cost < best) {
          best = cost;
          chosen = unknowns_.phases;
        }
        observer_.progress(0.1 + 0.1 * double(b * (steps + 1) + size_t(k) + 1) / double(bends.size() * (steps + 1)));
      }
    unknowns_.phases = chosen;
    std::vector<Unknown> free;
    add(free, UnknownKind::phase, unknowns_.phases.size(), 1);
    misfit_of(bench_, all, unknowns_);
    fit(bench_, all, free, FitEffort{}, unknowns_, part_of(observer_, 2, 10));
  }

  // A curvature moves the light of a lens at (x, y) by a multiple of (x, y), as another scale of the camera does.
  void search_curvature() {
    const std::vector<Exposure> seen = of_kind(PatternKind::focus);
    const std::vector<ZernikeTerm>& terms = bench_.basis().aberration;
    size_t k = 0;
    while (k < terms.size() && !(terms[k].n == 2 && terms[k].m == 0)) ++k;
    if (seen.empty() || k == terms.size()) return;
    const Grid& grid = bench_.basis().slm.grid;
    const double radius = std::hypot(grid.width(), grid.height()) / 2;
    // ψ = c·√3·(2ρ² − 1): slope c·4√3·r/R², moved by z·λ/2π times it.
    const double growth =
        4 * std::sqrt(3.0) / (radius * radius) * plan_.distance * bench_.basis().wavelength / (2 * pi);
    const Unknowns start = unknowns_;
    Unknowns chosen = start;
    double best = std::numeric_limits<double>::infinity();
    const int steps = int(2 * curvature_reach / curvature_step);
    for (int n = 0; n <= steps; ++n) {
      Unknowns u = start;
      const double c = -curvature_reach + n * curvature_step;
      u.aberration[k] = c;
      const double scale = 1 + growth * c;
      u.camera = {start.camera.a * scale, start.camera.b * scale, start.camera.x * scale, start.camera.y * scale};
      const double cost = misfit_of(bench_, seen, u).of_one();
      if (cost < best) {
        best = cost;
        chosen = u;
      }
    }
    unknowns_ = chosen;
    std::vector<Exposure> both = seen;
    for (const Exposure& exposure : of_kind(PatternKind::spots)) both.push_back(exposure);
    misfit_of(bench_, both, unknowns_);
    fit(bench_, both, optics(true), FitEffort{}, unknowns_, part_of(observer_, 3, 10));
  }

  FitResult fit_all() {
    misfit_of(bench_, exposures_, unknowns_);
    for (const Exposure& exposure : exposures_) {
      const double correlation = correlation_of(bench_, exposure, unknowns_);
      require(
          correlation >= least_correlation,
          "{}: expected a photograph of this pattern, got one whose correlation with it is {:.2f}; check that it was "
          "taken with this pattern on the panel and that the camera did not move",
          plan_.patterns[exposure.number].name, correlation);
    }
    Observer rest = observer_;
    rest.on_progress = [this](double fraction) { observer_.progress(0.4 + 0.6 * fraction); };
    FitResult result =
        fit(bench_, exposures_, everything(), {params_.iterations, last_tolerance, true}, unknowns_, rest);
    require(
        result.has_converged,
        "expected the fit to converge, but after {} iterations the misfit still falls; give more iterations, or lower "
        "the orders of the aberration and the light",
        result.iterations);
    return result;
  }

  std::vector<PhotographFit> explained(const FitResult& result) const {
    std::vector<PhotographFit> all;
    for (const Exposure& exposure : exposures_)
      all.push_back({plan_.patterns[exposure.number].name, correlation_of(bench_, exposure, unknowns_),
                     result.misfit.rms[exposure.number]});
    return all;
  }

  const CalibrationPlan& plan_;
  const CalibrateParams& params_;
  const Observer& observer_;
  CalibrationBench bench_;
  Unknowns unknowns_;
  std::vector<Exposure> exposures_;
};

}  // namespace

PanelFit fit_panel(const CalibrationPlan& plan, const std::vector<Image>& photographs, const CalibrateParams& params,
                   const Observer& observer) {
  check_ranges(params);
  check_inputs(plan, photographs);
  return PanelSearch(plan, params, observer).find(photographs);
}

namespace {

using Json = nlohmann::ordered_json;

Json with_error(const Measured& measured) { return {{"value", measured.value}, {"standard_error", measured.error}}; }

}  // namespace

nlohmann::ordered_json fit_json(const PanelFit& fit) {
  Json levels = Json::array(), aberration = Json::array(), photographs = Json::array();
  for (const MeasuredLevel& level : fit.levels)
    levels.push_back({{"level", level.level},
                      {"phase_rad", level.phase.value},
                      {"standard_error", level.phase.error},
                      {"assumed_phase_rad", level.assumed_phase},
                      {"amplitude", level.amplitude}});
  for (const MeasuredTerm& term : fit.aberration)
    aberration.push_back(
        {{"n", term.n}, {"m", term.m}, {"rms_rad", term.rms.value}, {"standard_error", term.rms.error}});
  for (const PhotographFit& p : fit.photographs)
    photographs.push_back({{"name", p.name}, {"correlation", p.correlation}, {"residual", p.residual}});
  return {{"levels", levels},
          {"crosstalk_pixels", with_error(fit.crosstalk)},
          {"gap_light", with_error(fit.gap_light)},
          {"gap_phase_rad", with_error(fit.gap_phase)},
          {"fill_factor", fit.slm.fill_factor},
          {"aberration", aberration},
          {"least_light", fit.least_light},
          {"most_light", fit.most_light},
          {"camera_scale", fit.camera_scale},
          {"camera_blur_pixels2", with_error(fit.camera_blur)},
          {"camera_rotation_deg", fit.camera_rotation * 180 / pi},
          {"photographs", photographs},
          {"iterations", fit.iterations},
          {"pixels", fit.pixels}};
}

}  // namespace holotrace
