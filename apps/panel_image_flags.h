#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "flags.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/panel_image.h"

namespace holotrace {

/// The flags that say what is done to holograms on their way to a panel.
class PanelImageFlags {
 public:
  void add(CLI::App& command);

  /// Whether one of them was given.
  bool are_given() const;

  /// How many pictures so many holograms become.
  size_t count(size_t holograms) const;

  /// Checks before the work what can be checked without levels: tables, sizes, and the file's format. @throws Error as images() and
  /// check_panel_image do
  void check(const std::vector<Hologram>& blank, const std::string& path) const;

  /// The pictures of holograms for a file with the ending of `path`. @throws Error  as panel_images and the readers of tables do
  std::vector<PanelImage> images(const std::vector<Hologram>& holograms, const std::string& path,
                                 const Observer& observer = {}) const;

  /// What was done, by the names of the flags.
  std::map<std::string, std::string> done() const;

 private:
  Flags flags_;
  std::string lut_, correction_;
};

}  // namespace holotrace
