#include "holotrace/data/named_light.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

constexpr std::string_view white_space = " \t\n";

std::string_view trimmed(std::string_view text) {
  const size_t first = std::min(text.find_first_not_of(white_space), text.size());
  return text.substr(first, text.find_last_not_of(white_space) + 1 - first);
}

// The name as it is compared: in lower case, without spaces and hyphens.
std::string compared(std::string_view name) {
  std::string out;
  for (const char c : name)
    if (white_space.find(c) == std::string_view::npos && c != '-')
      out += char(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

// Names of lights begin with a letter; lengths with a digit, a sign, or a word that is a number, such as "inf".
bool is_light(std::string_view text) {
  const std::string word = compared(text);
  double number = 0;
  return !word.empty() && std::isalpha(static_cast<unsigned char>(word[0])) &&
         std::from_chars(word.data(), word.data() + word.size(), number).ec != std::errc();
}

}  // namespace

const std::vector<NamedLight>& named_lights() {
  using namespace literals;
  static const std::vector<NamedLight> lights{
      {"HeNe", 632.8_nm, 0, "helium-neon laser, red line of neon: NIST Atomic Spectra Database, 632.82 nm"},
      {"HeNe yellow", 594.1_nm, 0, "helium-neon laser, yellow line of neon: NIST Atomic Spectra Database, 594.10 nm"},
      {"HeNe green", 543.37_nm, 0,
       "helium-neon laser, green line of neon: 543.516 nm in vacuum (BIPM), 543.365 nm in air"},
      {"HeCd", 441.6_nm, 0, "helium-cadmium laser, blue line of cadmium: NIST Atomic Spectra Database, 441.56 nm"},
      {"Ar 488", 488.0_nm, 0, "argon ion laser: NIST Atomic Spectra Database, 487.99 nm"},
      {"Ar 514", 514.5_nm, 0, "argon ion laser: NIST Atomic Spectra Database, 514.53 nm"},
      {"Kr 647", 647.1_nm, 0, "krypton ion laser: NIST Atomic Spectra Database, 647.09 nm"},
      {"Ruby", 694.3_nm, 0, "ruby laser, line R1: Maiman, Nature 187, 493 (1960), 694.3 nm"},
      {"Nd:YAG", 1064_nm, 0, "neodymium laser: Koechner, Solid-State Laser Engineering, 6th ed. (2006), 1064 nm"},
      {"DPSS 457", 457_nm, 0, "Cobolt Twist data sheet, nominal; diode-pumped, 914 nm doubled"},
      {"DPSS 473", 473_nm, 0, "Cobolt Blues data sheet, nominal; diode-pumped, 946 nm doubled"},
      {"DPSS 532", 532_nm, 0, "Cobolt Samba data sheet, nominal; diode-pumped, 1064 nm doubled"},
      {"DPSS 561", 561_nm, 0, "Cobolt Jive data sheet, nominal; diode-pumped, 1123 nm doubled"},
      {"DPSS 660", 660_nm, 0, "Cobolt Flamenco data sheet, nominal; diode-pumped, 1319 nm doubled"},
      {"Diode 405", 405_nm, 1_nm, "Thorlabs L405P20 data sheet, nominal; bandwidth typical of laser diodes"},
      {"Diode 450", 450_nm, 2_nm, "Osram PL TB450B data sheet, nominal; bandwidth typical of laser diodes"},
      {"Diode 520", 520_nm, 2_nm, "Osram PL 520 data sheet, nominal; bandwidth typical of laser diodes"},
      {"Diode 638", 638_nm, 1_nm, "Mitsubishi ML501P73 data sheet, nominal; bandwidth typical of laser diodes"},
      {"Diode 660", 660_nm, 1_nm, "Thorlabs L660P120 data sheet, nominal; bandwidth typical of laser diodes"},
      {"LED 455", 455_nm, 18_nm, "Thorlabs M455L4 data sheet, nominal; bandwidth typical"},
      {"LED 530", 530_nm, 35_nm, "Thorlabs M530L4 data sheet, nominal; bandwidth typical"},
      {"LED 625", 625_nm, 17_nm, "Thorlabs M625L4 data sheet, nominal; bandwidth typical"},
      {"LED 660", 660_nm, 20_nm, "Thorlabs M660L4 data sheet, nominal; bandwidth typical"},
  };
  return lights;
}

const NamedLight& light_named(std::string_view name) {
  const std::string wanted = compared(name);
  std::vector<std::string> known;
  for (const NamedLight& light : named_lights()) {
    known.push_back(compared(light.name));
    if (known.back() == wanted) return light;
  }
  const std::string nearest = nearest_name(wanted, known);
  const auto place = std::find(known.begin(), known.end(), nearest) - known.begin();
  const std::string advice = nearest.empty() ? "holotrace info --lights lists them"
                                             : "did you mean \"" + named_lights()[size_t(place)].name + "\"?";
  fail("expected a length with its unit, such as \"532 nm\", or a known light ({}), got \"{}\"", advice, trimmed(name));
}

double parse_wavelength(std::string_view text, std::string_view name) {
  return is_light(text) ? light_named(text).wavelength : parse_length(text, name);
}

std::vector<double> parse_wavelengths(std::string_view text, std::string_view name) {
  std::vector<std::string_view> parts;
  for (size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
    end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
  }
  const auto is_one = [](std::string_view part) { return is_light(trimmed(part)); };
  if (std::none_of(parts.begin(), parts.end(), is_one)) return parse_lengths(text, name);

  std::vector<double> wavelengths;
  std::string lengths;  // the parts since the last light: lengths may share a unit
  const auto read_lengths = [&] {
    if (lengths.find_first_not_of(", ") != std::string::npos)
      for (const double length : parse_lengths(lengths, name)) wavelengths.push_back(length);
    lengths.clear();
  };
  for (const std::string_view part : parts) {
    if (!is_one(part)) {
      lengths += (lengths.empty() ? "" : ",") + std::string(part);
      continue;
    }
    read_lengths();
    wavelengths.push_back(light_named(trimmed(part)).wavelength);
  }
  read_lengths();
  return wavelengths;
}

}  // namespace holotrace
