#pragma once
// Messages of errors.

#include <gtest/gtest.h>

#include <string>

#include "base/error.h"

namespace sf {

/// The message of the error that `act` ends with; empty without one.
template <class Error = base::InputError, class Act>
std::string refusal_of(Act&& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// The same from the name of `file` on, without the folders before it.
template <class Act>
std::string refusal_from(const std::string& file, Act&& act) {
  const std::string message = refusal_of(act);
  const std::size_t at = message.find(file);
  return at == std::string::npos ? message : message.substr(at);
}

inline void expect_in(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

}  // namespace sf
