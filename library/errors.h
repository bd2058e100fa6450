#pragma once
// Converts errors of the farm to those of the public interface.

#include <type_traits>

#include "base/error.h"
#include "cluster/failure.h"
#include "library/words.h"
#include "sensorfarm/simulation.h"

namespace sf::library {

/// Returns `call()`. @throws sensorfarm::DeviceError for base::DeviceError, sensorfarm::Error for base::InputError, and
/// the matching one for an error of any rank
template <class Call>
auto translated(Call&& call) -> std::invoke_result_t<Call> {
  try {
    return call();
  } catch (const cluster::Failure& failure) {
    if (failure.code() == 3) throw sensorfarm::DeviceError(in_own_words(failure.what()));
    throw sensorfarm::Error(in_own_words(failure.what()));
  } catch (const base::DeviceError& error) {
    throw sensorfarm::DeviceError(in_own_words(error.what()));
  } catch (const base::InputError& error) {
    throw sensorfarm::Error(in_own_words(error.what()));
  }
}

}  // namespace sf::library
