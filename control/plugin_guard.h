#pragma once
// Turns exceptions of users' code into errors.

#include <exception>

#include "base/error.h"

namespace sf::control {

inline constexpr const char* kUnknownException = "it threw something that is not a std::exception";

/// Returns the result of users' code. @param failed (const char* why) -> the exception to throw in place of its own
template <class Call, class Failed>
auto guarded_call(Call&& call, const Failed& failed) {
  try {
    return call();
  } catch (const std::exception& error) {
    throw failed(error.what());
  } catch (...) {
    throw failed(kUnknownException);
  }
}

/// Returns an object that users' code makes, which is not null. Errors in its settings pass.
/// @param refused (const char* why) -> the exception to throw in place of others
template <class Make, class Refused>
auto made_by_plugin(const Make& make, const Refused& refused) {
  decltype(make()) made;
  try {
    made = make();
  } catch (const base::InputError&) {
    throw;
  } catch (const std::exception& error) {
    throw refused(error.what());
  } catch (...) {
    throw refused(kUnknownException);
  }
  if (made == nullptr) throw refused("it returned none");
  return made;
}

}  // namespace sf::control
