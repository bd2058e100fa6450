#pragma once
// Errors of the farm as those of the public interface.

#include <type_traits>

#include "base/error.h"
#include "cluster/failure.h"
#include "sensorfarm/simulation.h"

namespace sf::library {

/// `call()`. @throws sensorfarm::DeviceError for base::DeviceError, sensorfarm::Error for base::InputError, either for
/// an error of any rank
template <class Call>
auto translated(Call&& call) -> std::invoke_result_t<Call> {
  try {
    return call();
  } catch (const cluster::Failure& failure) {
    if (failure.code() == 3) throw sensorfarm::DeviceError(failure.what());
    throw sensorfarm::Error(failure.what());
  } catch (const base::DeviceError& error) {
    throw sensorfarm::DeviceError(error.what());
  } catch (const base::InputError& error) {
    throw sensorfarm::Error(error.what());
  }
}

}  // namespace sf::library
