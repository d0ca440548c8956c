#include "holotrace/io/picture/formats/formats.h"

#include <algorithm>
#include <cmath>

namespace holotrace {

int Frames::duration(size_t i, double units_per_second, int least) const {
  const auto end_of = [&](size_t frames) { return std::llround(double(frames) * seconds * units_per_second); };
  return std::max(least, int(end_of(i + 1) - end_of(i)));
}

int PictureHeader::channel(const std::string& name) const {
  const auto found = std::find(channels.begin(), channels.end(), name);
  return found == channels.end() ? -1 : int(found - channels.begin());
}

std::string PictureHeader::text(const std::string& name) const {
  const auto found = texts.find(name);
  return found == texts.end() ? "" : found->second;
}

Samples samples_for(const PictureHeader& header) {
  const size_t count = size_t(header.columns) * size_t(header.rows) * header.channels.size();
  switch (header.type) {
    case SampleType::bits_8:
      return std::vector<uint8_t>(count);
    case SampleType::bits_16:
      return std::vector<uint16_t>(count);
    case SampleType::floats:
      break;
  }
  return std::vector<float>(count);
}

std::vector<std::string> channels_named(int count) {
  std::vector<std::string> names = count >= 3 ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"};
  if (count == 2 || count == 4) names.emplace_back("A");
  return names;
}

}  // namespace holotrace
