#include "holotrace/wave/propagate/propagation_axis.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/propagation_kernel.h"

namespace holotrace {
namespace {

// Positions closer than this fraction of a pitch count as equal: a Nyquist fringe turns by 3e-11 of a cycle there.
constexpr double same_place = 1e-11;

// The axis with its lattice set, from its windows, wavelength and distance.
PropagationAxis with_lattice(PropagationAxis a) {
  if (!a.is_on_lattice()) return a;
  const double shift = std::round(a.offset / a.input_pitch);
  require(std::abs(shift) < 1e9, "expected an output window within 1e9 samples of the input's in {}, got it {} away",
          a.name, format_length(a.offset));
  a.shift = int(shift);
  a.rest = a.offset - shift * a.input_pitch;
  if (std::abs(a.rest) < same_place * a.input_pitch) a.rest = 0;
  return a;
}

double critical(const PropagationAxis& a) { return critical_distance(a.reach(), a.wavelength, a.input_pitch); }

// Input samples in a period that holds both windows.
int least_period(const PropagationAxis& a) {
  const double samples = std::ceil(a.inputs + a.outputs * a.output_pitch / a.input_pitch * (1 - same_place));
  require(samples < 1e9, "expected windows of less than 1e9 input samples together in {}, got {:.3g}", a.name, samples);
  return int(samples);
}

// The frequency [1/m] whose light is displaced by x over |z|.
double frequency_at(const PropagationAxis& a, double x, bool is_paraxial) {
  const double z = std::abs(a.z);
  return is_paraxial ? x / (a.wavelength * z) : x / (a.wavelength * std::hypot(x, z));
}

struct Band {
  double first, last;
};

// Frequencies whose light goes from some input to some output sample; wider, up to the offsets of a whole period.
Band band_of(const PropagationAxis& a, int padded, bool is_paraxial) {
  const double half = padded * a.input_pitch / 2, nyquist = 1 / a.input_pitch;
  if (a.z == 0) return std::abs(a.middle()) > half ? Band{1, -1} : Band{-nyquist, nyquist};
  const double low = frequency_at(a, a.middle() - half, is_paraxial);
  const double high = frequency_at(a, a.middle() + half, is_paraxial);
  return a.z < 0 ? Band{-high, -low} : Band{low, high};
}

struct Taper {
  double width = 0;  // [m]
  BandEdge edge;
};

// A smooth band edge beyond the outermost offset x. Light of the taper's frequencies moves past x by up to the width W.
// Both halves of the rise must span `widths` deviations s of the edge, and the edge's own spread in space, 1/2πs, must
// stay `widths` times that away from x.
Taper taper_beyond(const PropagationAxis& a, double x, double sign, bool is_paraxial, double widths) {
  const auto frequency = [&](double beyond) { return sign * frequency_at(a, x + sign * beyond, is_paraxial); };
  if (a.z == 0 || frequency(0) >= 1 / (2 * a.input_pitch)) return {};  // the samples' own band ends first
  const double most = 2 * (a.farthest() - a.nearest() + a.input_pitch);
  const auto has_room = [&](double width) {
    const double rise = std::min(frequency(width) - frequency(width / 2), frequency(width / 2) - frequency(0));
    return rise * width * pi >= widths * widths;
  };
  double width = widths * std::sqrt(2 * a.wavelength * std::abs(a.z) / pi);
  while (!has_room(width) && width < most) width *= 1.1;
  return {width, {sign * frequency(width / 2), widths / (pi * width)}};
}

// With fewer than 16 samples in the band, the ringing of its edges dominates the result.
bool holds_angular_spectrum(const PropagationAxis& a) {
  if (std::abs(a.z) <= critical(a)) return true;
  const int padded = least_period(a);
  const Band band = band_of(a, padded, false);
  return std::min((band.last - band.first) * padded * a.input_pitch, double(padded)) >= 16;
}

// Mean side of the input and output windows that gives 16 samples: (window/λz)·window/2 samples, times 2.
double window_needed(const PropagationAxis& a) { return std::sqrt(4 * a.wavelength * std::abs(a.z)); }

// The pitch at which the Rayleigh–Sommerfeld kernel is sampled well over the windows.
double pitch_needed(const PropagationAxis& a) { return a.wavelength / 2 * std::hypot(1.0, a.z / a.reach()); }

std::string explain(const PropagationAxis& x, const PropagationAxis& y, double z) {
  const PropagationAxis& narrow = x.reach() < y.reach() ? x : y;
  const PropagationAxis& wide = x.reach() < y.reach() ? y : x;
  return fmt::format(
      "no method can sample a propagation over {} here: the window in {} would have to be {} or wider for the angular "
      "spectrum, or the pitch {} or finer for the Rayleigh–Sommerfeld kernel in {}",
      format_length(z), narrow.name, format_length(window_needed(narrow)), format_length(pitch_needed(wide)),
      wide.name);
}

// Checks that a method chosen by the user suits the distance; the error or warning says what would.
void check_method(PropagationMethod method, const PropagationAxis& x, const PropagationAxis& y,
                  const Observer& observer) {
  const double farthest = std::max(critical(x), critical(y)), z = std::abs(x.z);
  if (method == PropagationMethod::angular_spectrum) {
    require(holds_angular_spectrum(x) && holds_angular_spectrum(y),
            "the angular spectrum cannot sample a propagation over {}: it needs a window of {} × {} or wider; use "
            "rayleigh-sommerfeld, or a larger window",
            format_length(z), format_length(window_needed(x)), format_length(window_needed(y)));
    if (z >= farthest && z > 0)
      observer.warn(fmt::format(
          "the angular spectrum leaves out steep light over {}: {} a field of fine detail is off by some percent; use "
          "rayleigh-sommerfeld, which is exact here, or auto",
          format_length(z),
          farthest > 0 ? fmt::format("beyond {}", format_length(farthest))
                       : std::string("at a pitch of half a wavelength or less")));
  }
  if (method == PropagationMethod::fresnel) {
    const double rho2 = (x.reach() * x.reach() + y.reach() * y.reach()) / 4;  // from the axis to the panel's corner
    const double neglected = pi / 4 * rho2 * rho2 / (x.wavelength * z * z * z);
    if (neglected > 0.1)
      observer.warn(fmt::format(
          "the paraxial Fresnel kernel neglects up to {:.2g} rad of a wave from the panel's corner over {}; the other "
          "methods are exact here",
          neglected, format_length(z)));
  }
  if (method != PropagationMethod::rayleigh_sommerfeld || z >= farthest) return;
  const double pitch = std::min(pitch_needed(x), pitch_needed(y));
  require(z >= farthest / 20,
          "the Rayleigh–Sommerfeld kernel cannot be sampled over {} at a pitch of {}: it needs {} or finer; use "
          "angular-spectrum, or a finer pitch",
          format_length(z), format_length(x.input_pitch), format_length(pitch));
  observer.warn(
      fmt::format("the Rayleigh–Sommerfeld kernel aliases near the window's edges over {}: it is sampled well from {} "
                  "on, or at a pitch of {}; angular-spectrum is valid here",
                  format_length(z), format_length(farthest), format_length(pitch)));
}

// A period that is also a multiple of the output's pitch, if the pitches have a ratio of small integers. Plain
// transforms then give the output, without chirps.
int common_period(const PropagationAxis& a, int samples) {
  for (int n = 1; n <= 8; ++n) {
    const double m = a.output_pitch / a.input_pitch * n;
    if (std::round(m) < 1 || std::round(m) > 16 || std::abs(m - std::round(m)) > same_place) continue;
    const int steps = int(std::round(m));
    return steps * fft_good_length((samples + steps - 1) / steps);
  }
  return fft_good_length(samples);
}

// Restricts the frequencies to a band, as far as the samples can represent it.
void hold(PropagationAxis& a, Band band) {
  a.first = int(std::ceil(std::max(band.first * a.period(), -double(a.padded / 2))));
  a.last = int(std::floor(std::min(band.last * a.period(), double((a.padded - 1) / 2))));
}

void hold_all(PropagationAxis& a) { hold(a, {-1 / a.input_pitch, 1 / a.input_pitch}); }

void pad(PropagationAxis& a, int samples) {
  if (a.is_on_lattice()) a.parts = 2;
  a.padded = a.is_on_lattice() ? 2 * fft_good_length((samples + 1) / 2) : common_period(a, samples);
}

void sample_spectrum(PropagationAxis& a, bool is_paraxial, double widths) {
  const bool is_on_axis = a.is_on_lattice() && a.rest == 0 && std::abs(a.middle()) < same_place * a.input_pitch;
  if (is_on_axis) {
    pad(a, least_period(a));
    hold(a, band_of(a, a.padded, is_paraxial));
    a.is_even = -a.first >= a.last && -a.first - a.last <= 1;
    return;
  }
  Taper low = taper_beyond(a, a.nearest(), -1, is_paraxial, widths);
  Taper high = taper_beyond(a, a.farthest(), 1, is_paraxial, widths);
  pad(a, least_period(a) + int(std::ceil((low.width + high.width) / a.input_pitch)));
  Band band = band_of(a, a.padded, is_paraxial);
  if (a.z != 0) {
    const double nyquist = 1 / a.input_pitch;
    band.first = low.width > 0 ? frequency_at(a, a.nearest() - low.width, is_paraxial) : -nyquist;
    band.last = high.width > 0 ? frequency_at(a, a.farthest() + high.width, is_paraxial) : nyquist;
  }
  if (a.z < 0) {
    band = {-band.last, -band.first};
    std::swap(low, high);
    low.edge.at *= -1;
    high.edge.at *= -1;
  }
  a.low = low.edge;
  a.high = high.edge;
  hold(a, band);
}

// Takes the kernel's own frequencies over the offsets in use and over the taper beyond them. A Gaussian edge of
// standard deviation s falls off over `widths`·s in space and widths/2πs in frequency. The taper minimizes period·band.
void sample_kernel(PropagationAxis& a, bool is_paraxial, double widths) {
  const double span = a.farthest() - a.nearest();
  const auto frequency = [&](double x) { return frequency_at(a, x, is_paraxial); };
  const double product = widths * widths / pi;  // product of the taper's width and its bandwidth
  const double band = std::max(frequency(a.farthest()) - frequency(a.nearest()), product / (span + a.input_pitch));
  a.taper = std::sqrt(product * (span + a.input_pitch) / band);
  a.edge = a.taper / (2 * widths);
  const double margin = product / a.taper;
  const double samples = std::ceil((span + 2 * a.taper) / a.input_pitch);
  require(samples < 1e9, "expected windows of less than 1e9 input samples together in {}, got {:.3g}", a.name, samples);
  a.padded = common_period(a, int(samples) + 1);
  const double low = frequency(a.nearest() - a.taper) - margin, high = frequency(a.farthest() + a.taper) + margin;
  a.first = int(std::floor((a.z < 0 ? -high : low) * a.period()));
  a.last = int(std::ceil((a.z < 0 ? -low : high) * a.period()));
  a.kernel_samples = fft_good_length(a.frequencies());
}

}  // namespace

double PropagationAxis::reach() const {
  return (inputs * input_pitch + outputs * output_pitch) / 2 + std::abs(middle());
}

bool PropagationAxis::is_on_lattice() const { return output_pitch == input_pitch; }

PropagationAxis make_axis_x(const Grid& input, const Grid& output, double wavelength, double z) {
  return with_lattice({.name = "x",
                       .inputs = input.nx,
                       .outputs = output.nx,
                       .input_pitch = input.pitch,
                       .output_pitch = output.pitch,
                       .offset = output.x(0) - input.x(0),
                       .wavelength = wavelength,
                       .z = z});
}

PropagationAxis make_axis_y(const Grid& input, const Grid& output, double wavelength, double z) {
  return with_lattice({.name = "y",
                       .inputs = input.ny,
                       .outputs = output.ny,
                       .input_pitch = input.pitch,
                       .output_pitch = output.pitch,
                       .offset = input.y(0) - output.y(0),
                       .wavelength = wavelength,
                       .z = z});
}

const char* method_name(PropagationMethod method) {
  switch (method) {
    case PropagationMethod::angular_spectrum:
      return "angular-spectrum";
    case PropagationMethod::rayleigh_sommerfeld:
      return "rayleigh-sommerfeld";
    case PropagationMethod::fresnel:
      return "fresnel";
    case PropagationMethod::automatic:
      break;
  }
  return "auto";
}

PropagationMethod choose_method(const PropagationAxis& x, const PropagationAxis& y, PropagationMethod wanted,
                                const Observer& observer) {
  if (wanted != PropagationMethod::automatic) {
    check_method(wanted, x, y, observer);
    return wanted;
  }
  const double z = std::abs(x.z), farthest = std::max(critical(x), critical(y));
  if (z >= farthest && z > 0) {
    observer.fact("why",
                  fmt::format("{} is at or beyond z* = {}, from which the kernel is sampled well over the window",
                              format_length(z), format_length(farthest)));
    return PropagationMethod::rayleigh_sommerfeld;
  }
  require(holds_angular_spectrum(x) && holds_angular_spectrum(y), "{}", explain(x, y, z));
  observer.fact("why", fmt::format("{} is below z* = {}, up to which the padded transfer function is sampled well",
                                   format_length(z), format_length(farthest)));
  return PropagationMethod::angular_spectrum;
}

bool takes_fresnel_kernel(const PropagationAxis& a) {
  return std::abs(a.z) > 2 * a.input_pitch * a.reach() / a.wavelength;
}

void set_sampling(PropagationAxis& a, PropagationMethod method, bool is_kernel, double edge_widths) {
  const bool is_paraxial = method == PropagationMethod::fresnel;
  if (is_kernel && !a.is_on_lattice()) {
    sample_kernel(a, is_paraxial, edge_widths);
  } else if (is_kernel) {
    pad(a, least_period(a));
    hold_all(a);
    const int most = std::max(std::abs(a.shift - (a.inputs - 1)), std::abs(a.shift + a.outputs - 1));
    a.is_even = a.rest == 0 && most <= a.padded / 2;
  } else {
    sample_spectrum(a, is_paraxial, edge_widths);
    require(a.first <= a.last,
            "expected an output window that light from the input reaches over {}, got one whose centre is {} from the "
            "input's centre in {}; an input with a pitch of {} sends no light there; move the window closer to the "
            "input's centre, or use a finer input pitch",
            format_length(std::abs(a.z)), format_length(a.middle()), a.name, format_length(a.input_pitch));
  }
}

void set_periodic_sampling(PropagationAxis& a) {
  a.parts = 1;
  a.padded = a.inputs;
  hold_all(a);
  a.is_even = a.is_on_lattice() && a.rest == 0;
}

}  // namespace holotrace
