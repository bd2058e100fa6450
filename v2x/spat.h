#pragma once
// Signal phase and timing (SPaT): the states of the signal groups of intersections and the times at which they change.

#include "v2x/common.h"

namespace sf::v2x {

enum class PhaseState : std::uint8_t {
  unavailable,
  dark,
  stop_then_proceed,            ///< flashing red
  stop_and_remain,              ///< red
  pre_movement,                 ///< red and yellow
  permissive_movement_allowed,  ///< green; conflicting traffic may be present
  protected_movement_allowed,   ///< green
  permissive_clearance,         ///< yellow, after permissive green
  protected_clearance,          ///< yellow, after protected green
  caution_conflicting_traffic   ///< flashing yellow
};

/// [0.1 s] since the start of the UTC hour, or of the next hour if less than the current time; up to 35999, and 36000
/// in a leap second.
using TimeMark = std::uint16_t;
inline constexpr TimeMark kMoreThanAnHour = 36'000;
inline constexpr TimeMark kUnknownTime = 36'001;  ///< 36111 in editions from 2020 on

struct TimeChangeDetails {
  std::optional<TimeMark> start;  ///< of the state
  TimeMark min_end = kUnknownTime;
  std::optional<TimeMark> max_end;
  std::optional<TimeMark> likely;
  std::optional<std::uint8_t> confidence;  ///< of `likely`: row of a table of probabilities, in [0, 15]
  std::optional<TimeMark> next;            ///< when the movement is allowed again
  bool operator==(const TimeChangeDetails&) const = default;
};

struct AdvisorySpeed {
  std::uint8_t type = 0;                    ///< row of kAdvisorySpeedTypes
  std::optional<std::uint16_t> speed;       ///< [0.1 m/s] in [0, 500]; 500: unavailable
  std::optional<std::uint8_t> confidence;   ///< row of kSpeedConfidences
  std::optional<std::uint16_t> distance;    ///< [m] before the stop line, in [0, 10000]; 0: unknown
  std::optional<std::uint8_t> restriction;  ///< class of vehicles
  Regional regional;
  Additions additions;
  bool operator==(const AdvisorySpeed&) const = default;
};

/// A present or future state.
struct MovementEvent {
  PhaseState state = PhaseState::unavailable;
  std::optional<TimeChangeDetails> timing;
  std::vector<AdvisorySpeed> speeds;  ///< at most 16
  Regional regional;
  Additions additions;
  bool operator==(const MovementEvent&) const = default;
};

/// Queue and free space of a connection between lanes.
struct ManeuverAssist {
  std::uint8_t connection = 0;
  std::optional<std::uint16_t> queue_length;       ///< [m] in [0, 10000]
  std::optional<std::uint16_t> available_storage;  ///< [m] in [0, 10000]
  std::optional<bool> wait_on_stop;
  std::optional<bool> pedestrian_or_bicycle;
  Regional regional;
  Additions additions;
  bool operator==(const ManeuverAssist&) const = default;
};

/// A signal group. Its first event is the present state.
struct MovementState {
  std::string name;                    ///< at most 63 characters
  std::uint8_t signal_group = 0;       ///< 0: unknown, 255: permanently green
  std::vector<MovementEvent> events;   ///< 1 to 16
  std::vector<ManeuverAssist> assist;  ///< at most 16
  Regional regional;
  Additions additions;
  bool operator==(const MovementState&) const = default;
};

struct IntersectionState {
  std::string name;
  IntersectionReference id;
  std::uint8_t revision = 0;                  ///< in [0, 127]; changes with that of the MAP
  std::uint16_t status = 0;                   ///< bit 0, manual control, is the most significant
  std::optional<std::uint32_t> minute;        ///< of the year; kInvalidMinute: unknown
  std::optional<std::uint16_t> milliseconds;  ///< within the minute
  std::vector<std::uint8_t> enabled_lanes;    ///< open revocable lanes, at most 16
  std::vector<MovementState> states;          ///< 1 to 255
  std::vector<ManeuverAssist> assist;         ///< at most 16
  Regional regional;
  Additions additions;
  bool operator==(const IntersectionState&) const = default;
};

struct Spat {
  static constexpr std::uint16_t kMessageId = 19;
  static constexpr std::string_view kTag = "SPAT";
  std::optional<std::uint32_t> minute;  ///< of the year
  std::string name;
  std::vector<IntersectionState> intersections;  ///< 1 to 32
  Regional regional;
  Additions additions;
  bool operator==(const Spat&) const = default;
};

}  // namespace sf::v2x
