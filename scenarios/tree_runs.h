#pragma once
// Runs of a car in SimVille with five unlike sensors, for the experiment `tree`: tracks of objects and occupancy grids
// against the truth, for each choice of sensors.

#include <array>
#include <string_view>
#include <vector>

#include "scenarios/experiment.h"
#include "scenarios/track_errors.h"
#include "scenarios/tree_grids.h"

namespace sf::scenarios {

/// The sensors of the car, in the order of its features.
inline constexpr std::array<std::string_view, 5> kTreeSensors{"front laser", "back laser", "sonar", "infrared", "tags"};
inline constexpr unsigned kAllTreeSensors = (1u << kTreeSensors.size()) - 1;

/// Tracks from one choice of sensors, against the truth.
struct TreeTracks : TrackErrors {
  unsigned sensors = 0;          ///< bit k: sensor k is on
  std::size_t readings = 0;      ///< of tracks
  std::size_t targets = 0;       ///< robots in sight, over all readings
  std::size_t right_motion = 0;  ///< of the found, at rest or moving as decided
  std::size_t switches = 0;      ///< of the identity of a robot's track
  std::size_t tracks = 0;        ///< of objects, over all readings
  std::size_t false_tracks = 0;  ///< of nothing: neither a robot nor a surface is near
  std::size_t moving_walls = 0;  ///< of surfaces, taken for moving objects

  void add(const TreeTracks& other);
};

struct TreeRun {
  std::vector<TreeTracks> tracks;              ///< of each choice of at least one sensor: row k has the sensors k + 1
  std::vector<TreeGrid> grids;                 ///< TreeGrids::compare
  std::vector<maps::OccupancyGrid> own_grids;  ///< by the car's own poses: of all sensors; of sonar alone

  void add(const TreeRun& other);
};

/// Runs the scenario once.
TreeRun run_tree(const ExperimentContext& context, std::uint64_t seed);

}  // namespace sf::scenarios
