#include "holotrace/data/named_medium.h"

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"

namespace holotrace {

const std::vector<NamedMedium>& named_media() {
  constexpr double per_mm = 1000;
  static const std::vector<NamedMedium> media = [] {
    std::vector<NamedMedium> list{{"apple", {2.29, 2.39, 1.97}, {0.0030, 0.0034, 0.046}},
                                  {"chicken 1", {0.15, 0.21, 0.38}, {0.015, 0.077, 0.19}},
                                  {"chicken 2", {0.19, 0.25, 0.32}, {0.018, 0.088, 0.20}},
                                  {"cream", {7.38, 5.47, 3.15}, {0.0002, 0.0028, 0.0163}},
                                  {"firn", {0.314, 0.314, 0.314}, {1.66e-4, 2.81e-5, 2.90e-6}},
                                  {"fresh snow", {0.604, 0.604, 0.604}, {4.16e-5, 7.03e-6, 7.27e-7}},
                                  {"ketchup", {0.18, 0.07, 0.03}, {0.061, 0.97, 1.45}},
                                  {"marble", {2.19, 2.62, 3.00}, {0.0021, 0.0041, 0.0071}},
                                  {"potato", {0.68, 0.70, 0.55}, {0.0024, 0.0090, 0.12}},
                                  {"skimmed milk", {0.70, 1.22, 1.90}, {0.0014, 0.0025, 0.0142}},
                                  {"skin 1", {0.74, 0.88, 1.01}, {0.032, 0.17, 0.48}},
                                  {"skin 2", {1.09, 1.59, 1.79}, {0.013, 0.070, 0.145}},
                                  {"spectralon", {11.6, 20.4, 14.9}, {0, 0, 0}},
                                  {"whole milk", {2.55, 3.21, 3.77}, {0.0011, 0.0024, 0.014}}};
    for (NamedMedium& medium : list) medium.scattering *= per_mm, medium.absorption *= per_mm;
    return list;
  }();
  return media;
}

const NamedMedium& medium_named(const std::string& name) {
  std::vector<std::string> names;
  for (const NamedMedium& medium : named_media()) {
    if (medium.name == name) return medium;
    names.push_back(medium.name);
  }
  throw Error(unknown_name_message("substance", name, names));
}

}  // namespace holotrace
