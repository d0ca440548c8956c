#include "holotrace/base/suggest.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
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
    if (distance <= most && distance < best_distance) {
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

}  // namespace holotrace
