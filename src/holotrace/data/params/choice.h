#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "holotrace/base/error.h"

namespace holotrace {

/// The names of an enumeration's values.
template <class Enum>
struct Choice {
  const char* name;
  Enum value;
};

/// The name of a value.
/// @throws Error  if the value has none
template <class Enum>
const char* name_of(Enum value, std::initializer_list<Choice<Enum>> names) {
  for (const Choice<Enum>& choice : names)
    if (choice.value == value) return choice.name;
  fail("expected a value that has a name, got number {}", int(value));
}

template <class Enum>
std::vector<std::string> names_of(std::initializer_list<Choice<Enum>> choices) {
  std::vector<std::string> names;
  for (const Choice<Enum>& choice : choices) names.emplace_back(choice.name);
  return names;
}

}  // namespace holotrace
