#pragma once
// Converts errors of the farm to those of the public interface.

#include <string>
#include <type_traits>

#include "base/error.h"
#include "cluster/failure.h"
#include "sensorfarm/simulation.h"

namespace sf::library {

/// Returns `message` with the library's options (sensorfarm::Options, and the arguments of Python, which have the same
/// names) in place of those of the command line, which messages of the farm name.
std::string in_own_words(std::string message);

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
