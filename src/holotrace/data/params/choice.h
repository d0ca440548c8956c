#pragma once

// Every parameter of every stage is listed once: each header of this folder has one stage's parameters as a plain
// struct, and its `describe` lists their names, kinds and help texts. That list feeds scene files, flags and help
// texts. A visitor of `describe` has the members
//   count, number, flag      (name, value, help)     plain values
//   length, lengths, angle   (name, value, help)     text with a unit
//   choice                   (name, value, names, help)   one of a few names
//   texts                    (name, value, help)     a list of texts
//   coordinate               (name, value, help)     a length of any sign
//   position                 (name, value, help)     three lengths of any sign

namespace holotrace {

/// The names of an enumeration's values.
template <class Enum>
struct Choice {
  const char* name;
  Enum value;
};

}  // namespace holotrace
