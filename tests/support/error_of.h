#pragma once

#include <exception>
#include <string>

namespace holotrace {

/// The sentence of the exception that `call` throws; "no error" if it throws none.
template <class Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace holotrace
