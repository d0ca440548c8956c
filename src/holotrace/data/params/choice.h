#pragma once

#include <initializer_list>

#include "holotrace/base/error.h"
#include "holotrace/data/params/device.h"
#include "holotrace/data/params/range.h"

// Every parameter of every stage is listed once: each header of this folder has one stage's parameters as a plain
// struct, and its `describe` lists their names, kinds, ranges and help texts. That list feeds scene files, flags, help
// texts and the checks of the library's verbs (check_ranges.h). A visitor of `describe` has the members
//   count, number            (name, value, range, help)   plain values
//   length, lengths, angle   (name, value, range, help)   text with a unit
//   position                 (name, value, range of z, help)   three lengths, x and y of any sign
//   flag                     (name, value, help)     true or false
//   choice                   (name, value, names, help)   one of a few names
//   texts                    (name, value, help)     a list of texts
//   device                   (name, value, help)     where the stage computes: cpu, opencl, opencl:N, opencl:all, auto
// The range is never left out: a parameter that may have any value says range::any.

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

}  // namespace holotrace
