#pragma once
// Results of a tick, and the interface of recorders that the farm and the simulation use.

#include <cstdint>
#include <span>

#include "base/fault.h"
#include "base/reading.h"
#include "base/report.h"
#include "base/shape_state.h"
#include "base/state_quality.h"

namespace sf::base {

/// State of a traffic light.
struct LightStatus {
  std::uint8_t state = 0;  ///< 0 dark, 1 red, 2 yellow, 3 green, 4 flashing red, 5 flashing yellow
  double left = 0.0;       ///< [s] until the next change; infinity: unknown

  friend bool operator==(const LightStatus&, const LightStatus&) = default;
};

/// Results of one tick. The spans are valid during the call.
struct TickRecord {
  std::uint64_t tick = 0;
  std::int64_t time = 0;                    ///< [ns] simulated
  std::span<const Report> reports;          ///< true or estimated state of every mover; absent movers: kAbsent
  std::span<const Twist> commands;          ///< one per report: the twist that the controller commanded
  std::span<const std::uint8_t> contacts;   ///< one per report: 1 if a wall or a robot blocked the mover
  std::span<const ReadingBlock> readings;   ///< delivered this tick
  std::span<const StateQuality> qualities;  ///< one per report; empty: the states are exact
  std::span<const LightStatus> lights;      ///< one per traffic light of the world; empty: not recorded
  std::span<const FaultMark> faults;        ///< readings measured since the last tick that faults affected
  std::span<const ShapeState> shapes;       ///< of movers changed since the last tick; this tick has the new shapes
};

class Sink {
 public:
  virtual ~Sink() = default;
  virtual void write(const TickRecord& record) = 0;
};

}  // namespace sf::base
