#pragma once
// Errors of the farm as those of the public interface.

#include <type_traits>

#include "base/error.h"
#include "sensorfarm/simulation.h"

namespace sf::library {

/// `call()`. @throws sensorfarm::DeviceError for base::DeviceError, sensorfarm::Error for base::InputError
template <class Call>
auto translated(Call&& call) -> std::invoke_result_t<Call> {
  try {
    return call();
  } catch (const base::DeviceError& error) {
    throw sensorfarm::DeviceError(error.what());
  } catch (const base::InputError& error) {
    throw sensorfarm::Error(error.what());
  }
}

}  // namespace sf::library
