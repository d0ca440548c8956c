#include "holotrace/io/mesh/gltf_animation.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/keyframes.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/quaternion.h"

namespace holotrace {
namespace {

using Json = nlohmann::json;

// A sampler's keys: of a cubic spline, three values at each, its incoming slope, the value and its outgoing slope.
struct Sampler {
  Keyframes keys;
  bool is_cubic = false;
};

// What a channel sets: a member of the document, and how many numbers it has; 0: as many as the sampler gives.
struct Target {
  std::string pointer;
  size_t numbers = 0;
  bool is_rotation = false;
};

std::vector<double> all_numbers(const GltfFile& gltf, size_t accessor) {
  const std::string type = gltf.document.at("accessors").at(accessor).at("type").get<std::string>();
  return gltf_numbers(gltf, accessor, type == "VEC4" ? 4 : type == "VEC3" ? 3 : type == "VEC2" ? 2 : 1);
}

Sampler read_sampler(const GltfFile& gltf, const Json& source, const Target& target) {
  Sampler sampler;
  Keyframes& keys = sampler.keys;
  keys.times = gltf_numbers(gltf, gltf_count(gltf, source.at("input")), 1);
  const auto is_wrong = [](double a, double b) { return !(a < b); };
  require(!keys.times.empty() && std::isfinite(keys.times.back()) && std::isfinite(keys.times.front()) &&
              std::adjacent_find(keys.times.begin(), keys.times.end(), is_wrong) == keys.times.end(),
          "{}: expected times in their order in an animation, got others; export it again", gltf.path);
  const std::string interpolation = source.value("interpolation", "LINEAR");
  sampler.is_cubic = interpolation == "CUBICSPLINE";
  keys.interpolation = interpolation == "STEP" ? Interpolation::step : Interpolation::linear;
  const std::vector<double> numbers = all_numbers(gltf, gltf_count(gltf, source.at("output")));
  const size_t blocks = keys.times.size() * (sampler.is_cubic ? 3 : 1);
  const size_t each = target.numbers > 0 ? target.numbers : numbers.size() / blocks;
  require(each > 0 && numbers.size() == blocks * each &&
              std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n); }),
          "{}: expected {} finite numbers for the {} keys of {} in an animation, got {}; export it again", gltf.path,
          blocks * std::max<size_t>(each, 1), keys.times.size(), target.pointer, numbers.size());
  for (size_t i = 0; i < blocks; ++i)
    keys.values.emplace_back(numbers.begin() + std::ptrdiff_t(i * each),
                             numbers.begin() + std::ptrdiff_t((i + 1) * each));
  return sampler;
}

Quaternion quaternion_in(const std::vector<double>& q) { return normalize(Quaternion{q[0], q[1], q[2], q[3]}); }

std::vector<double> sample(const Sampler& sampler, bool is_rotation, double time) {
  const Keyframes& keys = sampler.keys;
  const auto [key, part] = place_among(keys.times, time);
  std::vector<double> value;
  if (sampler.is_cubic) {
    value = keys.values[3 * key + 1];
    if (part > 0) {
      const double duration = keys.times[key + 1] - keys.times[key];
      for (size_t i = 0; i < value.size(); ++i)
        value[i] = hermite(value[i], duration * keys.values[3 * key + 2][i], keys.values[3 * key + 4][i],
                           duration * keys.values[3 * key + 3][i], part);
    }
  } else if (is_rotation && part > 0 && keys.interpolation == Interpolation::linear) {
    const Quaternion q = slerp(quaternion_in(keys.values[key]), quaternion_in(keys.values[key + 1]), part);
    return {q.begin(), q.end()};
  } else {
    value = value_at(keys, time);
  }
  if (!is_rotation) return value;
  const Quaternion q = quaternion_in(value);
  return {q.begin(), q.end()};
}

// Whether a pointer of KHR_animation_pointer sets a number that is shown: of a material, or the visibility of a node.
bool is_shown(const std::string& pointer) {
  return pointer.starts_with("/materials/") ||
         (pointer.starts_with("/nodes/") && pointer.ends_with("/extensions/KHR_node_visibility/visible"));
}

// The target of a channel; nothing if it moves nothing that is shown.
std::optional<Target> target_of(const GltfFile& gltf, const Json& target, const WarnOnce& warn) {
  const std::string path = target.value("path", "");
  if (path == "pointer") {
    const std::string pointer = target.at("extensions").at("KHR_animation_pointer").at("pointer").get<std::string>();
    const size_t last = pointer.rfind('/') + 1;
    const bool is_of_element =
        pointer.find_first_not_of("0123456789", last) == pointer.npos;  // of a list, such as a colour's red
    if (!is_shown(pointer) || is_of_element) {
      warn("pointer", fmt::format("the animation of {} is ignored", pointer));
      return std::nullopt;
    }
    return Target{pointer, 0, false};
  }
  if (!target.contains("node")) return std::nullopt;  // as the standard has it
  const size_t node = gltf_count(gltf, target.at("node"));
  const std::string pointer = fmt::format("/nodes/{}/{}", node, path);
  const Json& nodes = gltf.document.at("nodes");
  if (path != "weights" && node < nodes.size() && nodes.at(node).contains("matrix")) {
    warn("matrix",
         fmt::format("the animation of node {} is ignored, because the node has a matrix; export it with translation, "
                     "rotation and scale",
                     node));
    return std::nullopt;
  }
  if (path == "translation" || path == "scale") return Target{pointer, 3, false};
  if (path == "rotation") return Target{pointer, 4, true};
  if (path == "weights") return Target{pointer, 0, false};
  warn(path, fmt::format("the animation of \"{}\" of nodes is ignored", path));
  return std::nullopt;
}

// The member of the document that a pointer names, which need not be there yet: "/materials/0/emissiveFactor". Only its
// second part may be a number, of an element that exists: lists do not grow.
Json& member_at(GltfFile& gltf, const std::string& pointer) {
  const auto damaged = [&] {
    fail("{}: expected an animation of a node or material of the file, got one of {}; export it again", gltf.path,
         pointer);
  };
  Json* at = &gltf.document;
  size_t number = 0;
  for (size_t begin = 1; begin <= pointer.size(); ++number) {
    const size_t end = std::min(pointer.find('/', begin), pointer.size());
    const std::string part = pointer.substr(begin, end - begin);
    begin = end + 1;
    if (number == 1) {
      const bool is_number = !part.empty() && part.size() < 10 && part.find_first_not_of("0123456789") == part.npos;
      if (!is_number || !at->is_array() || std::stoul(part) >= at->size()) damaged();
      at = &(*at)[std::stoul(part)];
    } else {
      if (part.empty() || !(at->is_object() || at->is_null())) damaged();
      at = &(*at)[part];
    }
  }
  if (number < 3) damaged();
  return *at;
}

void set_member(GltfFile& gltf, const Target& target, const std::vector<double>& value) {
  Json& member = member_at(gltf, target.pointer);
  if (target.pointer.ends_with("/visible"))
    member = value[0] != 0;
  else if (value.size() == 1 && !member.is_array() && !target.pointer.ends_with("/weights"))
    member = value[0];
  else
    member = value;
}

const Json* chosen_animation(const GltfFile& gltf, const std::string& name) {
  const auto found = gltf.document.find("animations");
  const bool are_there = found != gltf.document.end() && !found->empty();
  if (name.empty()) return are_there ? &found->at(0) : nullptr;
  std::vector<std::string> names;
  if (are_there)
    for (const Json& animation : *found) {
      names.push_back(animation.value("name", ""));
      if (names.back() == name) return &animation;
    }
  throw Error(gltf.path + ": " + unknown_name_message("animation", name, names));
}

}  // namespace

std::optional<double> pose_gltf(GltfFile& gltf, const PoseTime& at, const WarnOnce& warn) try {
  const Json* found = chosen_animation(gltf, at.animation);
  if (!found) return std::nullopt;
  const Json animation = *found;  // a copy: the document changes
  struct Channel {
    Target target;
    Sampler sampler;
  };
  std::vector<Channel> channels;
  std::optional<double> last;
  for (const Json& channel : animation.value("channels", Json::array())) {
    const auto target = target_of(gltf, channel.at("target"), warn);
    if (!target) continue;
    const Json& source = animation.at("samplers").at(gltf_count(gltf, channel.at("sampler")));
    channels.push_back({*target, read_sampler(gltf, source, *target)});
    const double end = channels.back().sampler.keys.times.back();
    last = std::max(last.value_or(end), end);
  }
  const double time =
      at.repeats && last && *last > 0 ? at.seconds - *last * std::floor(at.seconds / *last) : at.seconds;
  for (const Channel& channel : channels)
    set_member(gltf, channel.target, sample(channel.sampler, channel.target.is_rotation, time));
  return last;
} catch (const Json::exception& e) {
  fail("{}: expected a glTF model, but its animation is damaged ({}); export it again", gltf.path, reason(e));
}

}  // namespace holotrace
