#pragma once

#include <functional>
#include <optional>
#include <string>

namespace holotrace {

/// How compiled kernels are kept between runs, and where the messages of a compiler that refuses one go. Empty
/// functions keep nothing.
struct ProgramStore {
  std::function<std::optional<std::string>(const std::string& key)> load;  ///< what `save` got for that key
  std::function<void(const std::string& key, const std::string& binary)> save;
  std::function<std::string(const std::string& log)> save_log;  ///< returns the path of the file, "" for none
};

/// Sets the store of this program. A key names the device, its driver, the options and the source.
void set_program_store(ProgramStore store);

/// The store that was set.
const ProgramStore& program_store();

}  // namespace holotrace
