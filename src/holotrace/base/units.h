#pragma once

#include <numbers>
#include <string>
#include <string_view>
#include <vector>

namespace holotrace {

inline constexpr double pi = std::numbers::pi;

/// Lengths in C++ carry their unit: `532_nm`, `8.0_um`, `0.3_m`. The value is in metres.
namespace literals {
constexpr double operator""_m(long double v) { return double(v); }
constexpr double operator""_m(unsigned long long v) { return double(v); }
constexpr double operator""_cm(long double v) { return double(v / 1e2L); }
constexpr double operator""_cm(unsigned long long v) { return double(v / 1e2L); }
constexpr double operator""_mm(long double v) { return double(v / 1e3L); }
constexpr double operator""_mm(unsigned long long v) { return double(v / 1e3L); }
constexpr double operator""_um(long double v) { return double(v / 1e6L); }
constexpr double operator""_um(unsigned long long v) { return double(v / 1e6L); }
constexpr double operator""_nm(long double v) { return double(v / 1e9L); }
constexpr double operator""_nm(unsigned long long v) { return double(v / 1e9L); }
constexpr double operator""_deg(long double v) { return double(v * std::numbers::pi_v<long double> / 180); }
constexpr double operator""_deg(unsigned long long v) { return double(v * std::numbers::pi_v<long double> / 180); }
}  // namespace literals

/// A usual value of the key or flag with that name, for errors: "532 nm" for a wavelength.
const char* length_example(std::string_view name);

/// No length is larger [m]: over it, double precision has the phase of light to a thousandth of a cycle.
inline constexpr double most_length = 1e6;

/// Metres from a number with its unit: "532 nm", "8um", "-0.3 m". Units: m, cm, mm, um, µm, nm.
/// @param name  of the key or flag; errors give an example that suits it
/// @throws Error for a missing or unknown unit, or a number that is not finite or above most_length.
double parse_length(std::string_view text, std::string_view name = {});

/// Radians from a number with its unit: "15 deg", "0.2 rad", "3 mrad", "2.2 pi".
/// @throws Error for a missing or unknown unit, or a number that is not finite.
double parse_angle(std::string_view text);

/// A number from percent: "92 %" is 0.92.
/// @throws Error for another text, or a number that is not finite
double parse_percent(std::string_view text);

/// Seconds from a number with its unit: "0.5 s", "40 ms", "2 min". Units: s, ms, us, µs, min.
/// @throws Error for a missing or unknown unit, and a number that is not finite.
double parse_time(std::string_view text);

/// Seconds from several numbers that share one unit at the end, "0 0.5 1 s", or have one each.
std::vector<double> parse_times(std::string_view text);

/// Metres from several numbers that share one unit at the end, "0 0 -300 mm", or have one each,
/// "1 mm, 2 um, 0.3 m".
/// @throws Error as parse_length does.
std::vector<double> parse_lengths(std::string_view text, std::string_view name = {});

/// Bytes from a number with its unit: "2 GB", "512MiB". Units: B, kB, MB, GB, TB (powers of 1000), KiB, MiB, GiB, TiB.
/// @throws Error as parse_length does, and for a size of 0 or less.
double parse_size(std::string_view text);

/// Text of a part in percent: "0.35 %", "9.9 %", "87 %".
std::string format_percent(double part);

/// Text of a length in the unit that suits it: "532 nm", "8 µm", "300 mm".
std::string format_length(double metres);

/// Text of an angle: "2.267°".
std::string format_angle(double radians);

/// Text of a time: "0.5 s", "40 ms".
std::string format_time(double seconds);

/// Text of a number of bytes: "34.4 GiB".
std::string format_bytes(double bytes);

}  // namespace holotrace
