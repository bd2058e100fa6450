#pragma once
// Runs of traffic with probe vehicles and loop detectors, for the experiment `links`.

#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include "scenarios/experiment.h"

namespace sf::scenarios {

/// Sensors of one estimate.
struct LinkSet {
  int percent = 0;  ///< of the vehicles are probes
  bool loops = false;
};
inline constexpr LinkSet kLinkSets[] = {{0, true},  {5, false},  {5, true}, {10, false},
                                        {10, true}, {30, false}, {30, true}};
/// Returns the number of probes among `vehicles`: at least one, except for 0 %.
std::size_t probes_of(const LinkSet& set, std::size_t vehicles);

/// A place with traffic.
struct LinkPlan {
  std::string name;
  double interval = 0.0;    ///< [s] of truth and estimates
  double target = 0.0;      ///< [m/s] 7 km/h at full size
  double least_time = 0.0;  ///< [s] of all vehicles on a link in an interval that has a truth
};
LinkPlan corridor_plan();
LinkPlan town_plan();

/// One link in one interval.
struct LinkCell {
  std::uint64_t seed = 0;
  std::uint32_t link = 0;
  std::uint32_t interval = 0;                            ///< from 1
  double truth = NAN;                                    ///< [m/s] space-mean of all vehicles; NaN: too few
  std::array<double, std::size(kLinkSets)> speeds{};     ///< [m/s] estimates; NaN: not valid
  std::array<double, std::size(kLinkSets)> variances{};  ///< [m^2/s^2]
};

struct LinkRun {
  std::vector<std::string> links;
  std::vector<LinkCell> cells;  ///< by interval, then link
  std::size_t vehicles = 0;
};

inline constexpr double kCorridorEnd = 3600.0;  ///< [s]
/// Cars on a straight road of four links with two signals, at full size; from 1200 to 2400 s the signals have less
/// green, and queues grow. The first 300 s have no cells. @param duration [s]
LinkRun run_corridor(const ExperimentContext& context, std::uint64_t seed, double duration);
/// Cars on routes in SimVille.
LinkRun run_town_links(const ExperimentContext& context, std::uint64_t seed);

}  // namespace sf::scenarios
