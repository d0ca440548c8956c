#include "holotrace/base/message_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace holotrace {
namespace {

// Optimal string alignment: the number of letters that are inserted, left out, replaced, or exchanged with the next.
size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<size_t>> table(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i)
    for (size_t j = 0; j <= b.size(); ++j) {
      size_t& best = table[i][j];
      best = i == 0 || j == 0
                 ? i + j
                 : std::min({table[i - 1][j] + 1, table[i][j - 1] + 1, table[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        best = std::min(best, table[i - 2][j - 2] + 1);
    }
  return table[a.size()][b.size()];
}

// What a name means in other programs, or in plain words.
constexpr std::pair<std::string_view, std::string_view> meanings[] = {
    {"glass", "dielectric"},
    {"mirror", "conductor"},
    {"metal", "conductor"},
    {"matte", "diffuse"},
    {"lambertian", "diffuse"},
    {"pbr", "metallic-roughness"},
    {"principled", "metallic-roughness"},
    {"area", "rectangle"},
    {"sun", "directional"},
    {"laser", "laser-point"},
    {"cube", "box"},
    {"plane", "quad"},
    {"rect", "quad"},
    {"asm", "angular-spectrum"},
    {"gs", "gerchberg-saxton"},
    {"kinoform", "phase"},
    {"spp", "paths"},
    {"fov", "field_of_view"},
    {"focus", "distances"},
    {"aperture", "pupil"},
};

std::string meaning_of(std::string_view name, const std::vector<std::string>& known) {
  for (const auto& [foreign, own] : meanings)
    if (foreign == name && std::find(known.begin(), known.end(), own) != known.end()) return std::string(own);
  return "";
}

}  // namespace

std::string nearest_name(std::string_view name, const std::vector<std::string>& known) {
  constexpr size_t longest = 64;  // of a name; texts of files may be as long as the file
  std::string best;
  if (name.size() > longest) return best;
  if (std::string meant = meaning_of(name, known); !meant.empty()) return meant;
  const size_t letters = name.size() - std::min(name.find_first_not_of('-'), name.size());  // of a flag: without dashes
  size_t best_distance = longest;
  for (const std::string& candidate : known) {
    if (candidate.size() > longest) continue;
    // Other endings of one word are as near as a third of its letters elsewhere.
    constexpr size_t beginning = 4;
    const bool is_one_word = letters > beginning && candidate.starts_with(name.substr(0, beginning)) && name[0] != '-';
    const size_t most = is_one_word ? letters / 2 : std::max<size_t>(letters / 3, 1);
    const size_t distance = edit_distance(name, candidate);
    if (distance <= most && distance < best_distance && distance < name.size()) {  // one letter is not near another
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string unknown_name_message(std::string_view kind, std::string_view name, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(name, known);
  if (known.empty()) return fmt::format("unknown {} \"{}\"; none is defined", kind, name);
  if (!nearest.empty()) return fmt::format("unknown {} \"{}\"; did you mean \"{}\"?", kind, name, nearest);
  return fmt::format("unknown {} \"{}\"; known: {}", kind, name, fmt::join(known, ", "));
}

namespace {

struct Character {
  uint32_t code = 0;
  size_t size = 0;  // bytes; 0: not UTF-8
};

// The character that begins the text (RFC 3629).
Character first_character(std::string_view text) {
  const auto byte = [&](size_t i) { return uint32_t(static_cast<unsigned char>(text[i])); };
  const uint32_t lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const size_t size = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < size) return {};
  uint32_t code = lead & (0xFFu >> (size + 1));
  for (size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3F);
  }
  constexpr uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  return code < least[size] || code > 0x10FFFF || is_surrogate ? Character{} : Character{code, size};
}

bool is_control(uint32_t code) {
  const bool is_c0_or_c1 = code < 0x20 || (code >= 0x7F && code < 0xA0);
  const bool turns_direction = (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
  const bool ends_line = code == 0x2028 || code == 0x2029;
  return is_c0_or_c1 || turns_direction || ends_line;
}

}  // namespace

std::string printable(std::string_view text, size_t most) {
  std::string out;
  while (!text.empty()) {
    if (out.size() > most) return out + " …";
    const Character character = first_character(text);
    if (character.size == 0)
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
    else if (character.code == '\n')
      out += "\\n";
    else if (is_control(character.code))
      out +=
          character.code < 0x100 ? fmt::format("\\x{:02x}", character.code) : fmt::format("\\u{:04x}", character.code);
    else
      out += text.substr(0, character.size);
    text.remove_prefix(character.size == 0 ? 1 : character.size);
  }
  return out;
}

}  // namespace holotrace
