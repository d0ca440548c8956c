#include "holotrace/io/user_cache.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "holotrace/base/archive.h"
#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/folders.h"
#include "holotrace/io/files/text.h"

namespace holotrace {
namespace {

using Json = nlohmann::ordered_json;

// The content of the file; an empty object if it cannot be read.
Json read_machines(const std::string& path) {
  if (!is_file(path)) return Json::object();
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

// The rates under a key, by the names in the list of their terms.
template <class Rates, class Terms>
std::optional<Rates> rates_of(const Json& machines, const std::string& key, const Terms& terms) {
  const auto found = machines.find(key);
  if (found == machines.end() || !found->is_object()) return std::nullopt;
  Rates rates;
  double sum = 0;
  for (const auto& term : terms) {
    const auto value = found->find(term.name);
    if (value == found->end() || !value->is_number()) return std::nullopt;
    const double rate = value->template get<double>();
    if (!std::isfinite(rate) || rate < 0) return std::nullopt;
    rates.*term.rate = rate;
    sum += rate;
  }
  return sum > 0 ? std::optional(rates) : std::nullopt;
}

template <class Rates, class Terms>
Json json_of(const Rates& rates, const Terms& terms) {
  Json json;
  for (const auto& term : terms) json[term.name] = rates.*term.rate;
  return json;
}

using Warn = std::function<void(const std::string& sentence)>;

template <class Rates, class Terms>
Rates keep_rates(const std::string& name, const Terms& terms, const std::string& key,
                 const std::function<Rates()>& calibrate, const Warn& warn) {
  const std::optional<std::string> folder = writable_cache_folder();
  if (!folder) return {};
  const std::string path = *folder + "/" + name;
  try {
    // The file is replaced as a whole, so it may be read without the lock.
    if (const std::optional<Rates> kept = rates_of<Rates>(read_machines(path), key, terms)) return *kept;
    LockFile lock(path + ".lock");
    if (!lock.lock()) {
      warn(locked_message(path, "methods are chosen by default rates, not by rates of this machine"));
      return {};
    }
    Json machines = read_machines(path);
    if (const std::optional<Rates> kept = rates_of<Rates>(machines, key, terms)) return *kept;
    const Rates rates = calibrate();
    machines[key] = json_of(rates, terms);
    write_text(path, machines.dump(2) + "\n");
    return rates;
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

SummationRates keep_summation_rates(const std::string& key, const std::function<SummationRates()>& calibrate,
                                    const Warn& warn) {
  return keep_rates("summation_rates.json", summation_terms, key, calibrate, warn);
}

DeviceRates keep_device_rates(const std::string& key, const std::function<DeviceRates()>& calibrate, const Warn& warn) {
  return keep_rates("device_rates.json", device_rate_terms, key, calibrate, warn);
}

namespace {

// Compiled kernels run in this process, so only files that nobody else could have written are taken.
bool is_own(const std::string& path, mode_t kind) {
  struct stat found {};
  return lstat(path.c_str(), &found) == 0 && (found.st_mode & S_IFMT) == kind && found.st_uid == geteuid();
}

std::string path_in_cache(const std::string& name) {
  const std::optional<std::string> cache = writable_cache_folder();
  if (!cache) return "";
  const std::string folder = *cache + "/opencl";
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed || !is_own(folder, S_IFDIR) || chmod(folder.c_str(), S_IRWXU) != 0) return "";
  return folder + "/" + name;
}

std::string path_of(const std::string& key) { return path_in_cache(fmt::format("{:016x}.bin", fingerprint_of(key))); }

// Different keys may have the same fingerprint, so a file begins with its key. Drivers abort on damaged programs, so the
// fingerprint of the program follows.
std::string head_of(const std::string& key, const std::string& binary) {
  return fmt::format("{}\n{}\n{:016x}\n", key.size(), key, fingerprint_of(binary));
}

}  // namespace

std::optional<std::string> load_kept_program(const std::string& key) {
  const std::string path = path_of(key);
  if (path.empty() || !is_own(path, S_IFREG)) return std::nullopt;
  try {
    const std::string content = read_text(path);
    const size_t head = head_of(key, "").size();  // as long as that of any program
    if (content.size() <= head) return std::nullopt;
    std::string binary = content.substr(head);
    if (!content.starts_with(head_of(key, binary))) return std::nullopt;
    return binary;
  } catch (const Error&) {
    return std::nullopt;
  }
}

void keep_program(const std::string& key, const std::string& binary) {
  const std::string path = path_of(key);
  if (path.empty()) return;
  try {
    write_text(path, head_of(key, binary) + binary);
  } catch (const Error&) {
    // It will be compiled again.
  }
}

std::string keep_compiler_log(const std::string& log) {
  const std::string path = path_in_cache("compiler.log");
  if (path.empty()) return "";
  try {
    write_text(path, log);
    return path;
  } catch (const Error&) {
    return "";
  }
}

}  // namespace holotrace
