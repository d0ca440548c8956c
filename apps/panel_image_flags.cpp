#include "panel_image_flags.h"

#include <filesystem>

#include "holotrace/data/params/panel_image.h"
#include "holotrace/io/picture/panel_image_file.h"
#include "holotrace/slm/encode/panel_images.h"

namespace holotrace {

void PanelImageFlags::add(CLI::App& command) {
  const char* group = "Pictures for a panel";
  flags_.add(command, PanelImageParams(), {}, group);
  command
      .add_option(
          "--lut", lut_,
          "level table of the panel's maker: a line for each grey or level with the value that is sent, or with both")
      ->type_name("FILE")
      ->group(group);
  command
      .add_option(
          "--correction", correction_,
          "phase correction of the panel's maker, added to the turned picture: a grey picture of 8 or 16 bits, all greys a full "
          "cycle; a .csv of levels; or a .npy of phases in radians")
      ->type_name("FILE")
      ->group(group);
}

bool PanelImageFlags::are_given() const { return !flags_.texts().empty() || !lut_.empty() || !correction_.empty(); }

size_t PanelImageFlags::count(size_t holograms) const {
  PanelImageParams params;
  flags_.apply(params);
  const size_t each = params.packing == Packing::none ? 1 : params.packing == Packing::colours ? 3 : 24;
  return (holograms + each - 1) / each;
}

void PanelImageFlags::check(const std::vector<Hologram>& blank, const std::string& path) const {
  if (are_given())
    for (const PanelImage& image : images(blank, path)) check_panel_image(path, image);
  else
    for (const Hologram& one : blank) check_panel_image(path, {one.grid.nx, one.grid.ny, 1, grey_bits(one.levels), {}});
}

std::vector<PanelImage> PanelImageFlags::images(const std::vector<Hologram>& holograms, const std::string& path,
                                                const Observer& observer) const {
  PanelImageParams params;
  flags_.apply(params);
  const int levels = holograms.empty() ? 0 : holograms.front().levels;
  return panel_images(holograms, params, load_panel_tables(lut_, correction_, levels), value_in(path), observer);
}

std::map<std::string, std::string> PanelImageFlags::done() const {
  std::map<std::string, std::string> done = flags_.texts();
  const auto add = [&](const char* name, const std::string& path) {
    if (!path.empty()) done[name] = std::filesystem::path(path).filename().string();
  };
  add("lut", lut_);
  add("correction", correction_);
  return done;
}

}  // namespace holotrace
