#pragma once

#include <nanobind/stl/vector.h>

#include <string>
#include <utility>
#include <vector>

#include "holotrace/run/view_holograms.h"
#include "nouns.h"

// Results of verbs that make several things at once.

namespace holotrace::python {

template <class Noun>
nb::list moved(std::vector<Noun>& nouns) {
  nb::list list;
  for (Noun& noun : nouns) list.append(nb::cast(std::move(noun)));
  return list;
}

/// Copies of the nouns of a list in a dict.
template <class Noun>
std::vector<Noun> nouns_of(const nb::dict& made, const char* name) {
  return nb::cast<std::vector<Noun>>(made[name]);
}

inline ViewSeries series_of(const nb::dict& made, const char* name, const char* white) {
  return {nouns_of<Image>(made, name), nb::cast<double>(made[white])};
}

std::string json_of(const Report& report);

}  // namespace holotrace::python
