#include "holotrace/io/scene/key_places.h"

#include <fmt/format.h>

#include <map>

#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/params/render.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/params/trace.h"

namespace holotrace {
namespace {

using Places = std::multimap<std::string, std::string>;  // by key

template <class Params>
void add_keys(Places& places, const char* table) {
  Params params;
  describe([&](const auto& key) { places.emplace(key.name, fmt::format("below [{}]", table)); }, params);
}

Places all_places() {
  Places places;
  for (const char* key : {"preset", "columns", "rows", "pitch", "levels", "fill_factor", "modulation"})
    places.emplace(key, "below [slm]");
  for (const char* key : {"type", "position", "rotation", "material", "width", "height", "radius", "scale", "file"})
    places.emplace(key, "below [[object]]");
  places.emplace("radiance", "below [[light]]");
  places.emplace("wavelength", "above all headings");
  places.emplace("background", "above all headings");
  add_keys<TraceParams>(places, "trace");
  add_keys<RenderParams>(places, "render");
  add_keys<SynthesizeParams>(places, "synthesize");
  add_keys<EncodeParams>(places, "encode");
  add_keys<ShowParams>(places, "show");
  add_keys<PropagateParams>(places, "propagate");
  add_keys<CameraParams>(places, "camera");
  return places;
}

}  // namespace

std::vector<std::string> tables_with(const std::string& key) {
  static const Places places = all_places();
  std::vector<std::string> tables;
  const auto [begin, end] = places.equal_range(key);
  for (auto place = begin; place != end; ++place) tables.push_back(place->second);
  return tables;
}

}  // namespace holotrace
