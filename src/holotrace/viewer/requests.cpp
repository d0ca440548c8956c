#include "holotrace/viewer/requests.h"

#include <algorithm>
#include <charconv>
#include <set>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/data/params/hologram.h"
#include "holotrace/data/params/parameter_texts.h"

namespace holotrace {
namespace {

const char* const own_keys[] = {"items", "draft"};
constexpr std::string_view edit_key = "set.";

// Fields that a page cannot set: it asks for one picture, and the program's caller chooses devices.
const std::set<std::string> left_out{"sweep",         "sweep_views",  "sweep_from", "sweep_to",
                                     "sweep_seconds", "sweep_format", "device"};

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string decoded(const std::string& text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i] == '+' ? ' ' : text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
    require(high >= 0 && low >= 0 && (high > 0 || low > 0), "expected two hexadecimal digits after % in the request");
    out += char(high * 16 + low);
    i += 2;
  }
  return out;
}

std::string flag_of(const std::string& field) {
  std::string name = field == "distances" ? "distance" : field;
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

// Fields of parameter sets by their flags.
template <class... Params>
std::map<std::string, std::string> fields_of(Params... params) {
  std::map<std::string, std::string> fields;
  const auto add = [&](const auto& parameter) {
    if (left_out.count(parameter.name) == 0) fields[flag_of(parameter.name)] = parameter.name;
  };
  (describe(add, params), ...);
  return fields;
}

// The fields that a query can set.
const std::map<std::string, std::string>& fields_by_key() {
  static const std::map<std::string, std::string> fields = fields_of(ShowParams(), CameraParams());
  return fields;
}

std::vector<size_t> numbers_below(const std::string& text, size_t items) {
  std::vector<size_t> numbers;
  for (size_t at = 0; at <= text.size();) {
    const size_t end = std::min(text.find(',', at), text.size());
    size_t number = 0;
    const auto [stop, error] = std::from_chars(text.data() + at, text.data() + end, number);
    require(error == std::errc() && stop == text.data() + end && number < items,
            "expected numbers of holograms from 0 to {} in \"items\", got \"{}\"", items - 1, printable(text, 80));
    require(std::find(numbers.begin(), numbers.end(), number) == numbers.end(),
            "expected each hologram once in \"items\", got {} twice", number);
    numbers.push_back(number);
    at = end + 1;
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

}  // namespace

Query parse_query(const std::string& text) {
  require(text.size() <= most_query_bytes, "expected a request of at most {} bytes, got {}", most_query_bytes,
          text.size());
  Query query;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('&', at), text.size());
    const std::string pair = text.substr(at, end - at);
    const size_t equals = std::min(pair.find('='), pair.size());
    const std::string key = decoded(pair.substr(0, equals));
    const std::string value = equals < pair.size() ? decoded(pair.substr(equals + 1)) : "";
    require(query.emplace(key, value).second, "expected each key once in the request, got \"{}\" twice",
            printable(key, 80));
    at = end + 1;
  }
  return query;
}

ViewState view_state(const Query& query, const ViewState& defaults, size_t items) {
  ViewState state = defaults;
  std::map<std::string, std::string> texts;
  for (const auto& [key, value] : query) {
    if (const auto field = fields_by_key().find(key); field != fields_by_key().end()) {
      texts[field->second] = value;
    } else if (key == "items") {
      require(items > 0, "expected no \"items\", because there is no hologram here yet");
      state.shown = numbers_below(value, items);
    } else if (key == "draft") {
      require(value == "1" || value == "2", "expected 1 or 2 for \"draft\", got \"{}\"", printable(value, 80));
      state.is_draft = true;
      state.step = value == "2" ? 2 : 1;
    } else if (key.starts_with(edit_key)) {
      state.edits.push_back({key.substr(edit_key.size()), value});
    } else {
      std::vector<std::string> known(std::begin(own_keys), std::end(own_keys));
      for (const auto& [name, field] : fields_by_key()) known.push_back(name);
      throw Error(unknown_name_message("key", printable(key, 80), known));
    }
  }
  set_from_texts(state.show, texts, flag_of);
  set_from_texts(state.camera, texts, flag_of);
  require(state.camera.distances.size() == 1, "expected one distance, got {}", state.camera.distances.size());
  require(state.show.subpixels <= most_subpixels, "expected at most {} subpixels here, got {}; use holotrace show",
          most_subpixels, state.show.subpixels);
  require(state.show.illumination_states <= most_illumination_states,
          "expected at most {} illumination states here, got {}; use holotrace show", most_illumination_states,
          state.show.illumination_states);
  return state;
}

std::vector<std::string> show_arguments(const Query& query) {
  static const std::map<std::string, std::string> flags = fields_of(ShowParams(), CameraParams(), HologramParams());
  std::vector<std::string> arguments;
  for (const auto& [key, value] : query)
    if (flags.count(key) > 0) {
      arguments.push_back("--" + key);
      arguments.push_back(value);
    }
  return arguments;
}

std::string shell_word(const std::string& text) {
  const bool is_plain = !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string("-_./=,:+@").find(c) != std::string::npos;
  });
  if (is_plain) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

}  // namespace holotrace
