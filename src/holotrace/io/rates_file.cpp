#include "holotrace/io/rates_file.h"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "holotrace/base/error.h"
#include "holotrace/io/files/cache_folder.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/nesting.h"

namespace holotrace {
namespace {

using Json = nlohmann::ordered_json;

// The content of the file; an empty object if it cannot be read.
Json read_machines(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) return Json::object();
  try {
    const std::string text = read_text(path, most_text);
    check_json_nesting(text, path);
    Json json = Json::parse(text, nullptr, false);
    if (json.is_object()) return json;
  } catch (const Error&) {
    // A damaged file is replaced.
  }
  return Json::object();
}

std::optional<SummationRates> rates_of(const Json& machines, const std::string& key) {
  const auto found = machines.find(key);
  if (found == machines.end() || !found->is_object()) return std::nullopt;
  SummationRates rates;
  double sum = 0;
  for (const SummationTerm& term : summation_terms) {
    const auto value = found->find(term.name);
    if (value == found->end() || !value->is_number()) return std::nullopt;
    const double rate = value->get<double>();
    if (!std::isfinite(rate) || rate < 0) return std::nullopt;
    rates.*term.rate = rate;
    sum += rate;
  }
  return sum > 0 ? std::optional(rates) : std::nullopt;
}

Json json_of(const SummationRates& rates) {
  Json json;
  for (const SummationTerm& term : summation_terms) json[term.name] = rates.*term.rate;
  return json;
}

}  // namespace

SummationRates keep_summation_rates(const std::string& key, const std::function<SummationRates()>& calibrate,
                                    const std::function<void(const std::string& sentence)>& warn) {
  const std::optional<std::string> folder = writable_cache_folder();
  if (!folder) return {};
  const std::string path = *folder + "/summation_rates.json";
  try {
    // The file is replaced as a whole, so it may be read without the lock.
    if (const std::optional<SummationRates> kept = rates_of(read_machines(path), key)) return *kept;
    LockFile lock(path + ".lock");
    if (!lock.lock()) {
      warn(locked_message(path, "methods are chosen by the default rates"));
      return {};
    }
    Json machines = read_machines(path);
    if (const std::optional<SummationRates> kept = rates_of(machines, key)) return *kept;
    const SummationRates rates = calibrate();
    machines[key] = json_of(rates);
    write_text(path, machines.dump(2) + "\n");
    return rates;
  } catch (const Error&) {
    return {};
  }
}

}  // namespace holotrace
