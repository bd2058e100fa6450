#pragma once
// Converts the options of `run` or `serve` to the settings of a run for its recording and bridges.

#include <string>
#include <utility>

#include "scenarios/run_info.h"

namespace sf::apps {

/// @param caster description of the ray caster
template <class Options>
scenarios::RunSettings run_settings(const Options& options, const std::string& caster, bool record_readings) {
  std::string faults;
  if constexpr (requires { options.faults; }) faults = options.faults;
  return {.seed = options.seed,
          .record_readings = record_readings,
          .no_return_inf = options.no_return_inf,
          .caster = caster,
          .too_near_min = options.too_near_min,
          .naming = options.naming,
          .images = options.images,
          .faults = std::move(faults)};
}

}  // namespace sf::apps
