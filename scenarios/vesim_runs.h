#pragma once
// Runs of a car on a full-size road in traffic, for the experiment `vesim`: tracks of cars and its own position against
// the truth, with all of its sensors and with some of them.

#include <array>
#include <cstdint>
#include <string_view>

#include "scenarios/experiment.h"
#include "scenarios/track_errors.h"

namespace sf::scenarios {

/// The sensors that feed the tracks, and the inputs of each choice, as in the world file.
struct VesimChoice {
  std::string_view name, inputs;
};
inline constexpr std::array<VesimChoice, 6> kVesimChoices{
    {{"all", "localization\nfeatures:0\nfeatures:1\nfeatures:2\nradar"},
     {"lidars and radar", "localization\nfeatures:0\nfeatures:1\nradar"},
     {"camera and radar", "localization\nfeatures:2\nradar"},
     {"lidars", "localization\nfeatures:0\nfeatures:1"},
     {"radar", "localization\nradar"},
     {"camera", "localization\nfeatures:2"}}};

/// [m] ends of the classes of range
inline constexpr std::array<double, 5> kVesimRanges{20.0, 40.0, 60.0, 80.0, 120.0};

/// Tracks of the cars within one class of range. Ranks exchange the bytes of this and of the structures below.
struct VesimCell : TrackErrors {
  std::uint64_t targets = 0;  ///< cars in sight, over all readings
};

struct VesimTracks {
  std::uint64_t readings = 0;
  std::uint64_t switches = 0;      ///< of the identity of a car's track
  std::uint64_t ghosts = 0;        ///< moving objects where neither a car nor a surface is
  std::uint64_t moving_walls = 0;  ///< surfaces of houses and trees, taken for moving objects
  std::uint64_t nothings = 0;      ///< objects at rest where neither a car nor a surface is
  /// By range: ahead, in the radar's field of view; elsewhere.
  std::array<std::array<VesimCell, kVesimRanges.size()>, 2> cells{};
};

/// Errors of positions.
struct VesimPlace {
  std::uint64_t readings = 0;
  double squares = 0.0;  ///< [m^2]
  double largest = 0.0;  ///< [m]
  double nees = 0.0;     ///< sum; NaN: no covariance is stated
};

struct VesimRun {
  std::uint64_t seed = 0;
  std::uint64_t hash = 0;  ///< of all readings
  std::uint64_t contacts = 0;
  std::array<VesimTracks, kVesimChoices.size()> tracks;
  VesimPlace gps, fused;  ///< of the receiver's antenna, and of the car

  void add(const VesimRun& other);
};

/// Runs the scenario once: the seed chooses all noise, and the speeds and starts of the other cars.
/// @throws base::InputError for another world
VesimRun run_vesim(const ExperimentContext& context, std::uint64_t seed);

/// Runs all trials, of which each rank has its share.
/// @return one row per trial, on all ranks
std::vector<VesimRun> run_vesim_trials(const ExperimentContext& context);

}  // namespace sf::scenarios
