#pragma once
// Bridges connect a run or a service to programs of other people: viewers, ROS 2, clients of Player. Each tick goes
// out to all of them, and what their users asked for comes back before the next tick:
//
//   bridges.publish(simulation.step(), state);
//   bridges.take(requests);
//
// A bridge does its input and output on a thread of its own. A slow or hostile client costs itself readings, never a
// tick.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/pose.h"
#include "base/tick_record.h"
#include "record/run_info.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::bridges {

/// What a run consists of. All three outlive its bridges.
struct Scene {
  const world::World& world;
  const sensors::SensorSet& sensor_set;
  const record::RunInfo& info;  ///< with frames and topics (`record::name_frames`); movers are rows of the world's
  bool simulated = true;        ///< robots are moved by the simulation and take commands; false: `serve`
  std::vector<std::string> world_folders = {};  ///< whose worlds users may load; empty: none
};

/// Outcome of a request that the run may refuse, written before the next `publish`.
struct Outcome {
  enum class Fault : std::uint8_t { none, failed, unreadable, unsupported };
  bool done = false;
  Fault fault = Fault::none;
  std::string reason;  ///< of a fault
};

/// A robot that is to join, a copy of another.
struct Joining {
  std::string name, like;  ///< see world::append_robot
  base::Pose X_WM;         ///< finite
  std::shared_ptr<Outcome> outcome;
};

struct Leaving {
  std::uint32_t mover = 0;
  std::shared_ptr<Outcome> outcome;
};

/// A world to go on with, from time 0, paused.
struct WorldChange {
  std::string file;     ///< empty: a world without anything
  bool strict = false;  ///< files with warnings are refused
  std::shared_ptr<Outcome> outcome;
};

/// A mover's velocity, in its frame, in force until the next one.
struct Command {
  std::uint32_t mover = 0;
  base::Twist twist;  ///< finite
};

struct Placement {
  std::uint32_t mover = 0;
  base::Pose X_WM;  ///< finite
};

/// What users asked for since the last call, in the order in which it came. Bridges refuse requests that name no mover,
/// are not finite, or come where robots are not simulated.
struct Requests {
  std::vector<Command> commands;  ///< from its first on, a robot is driven from outside, no longer by its controller
  std::vector<Placement> placements;
  std::optional<bool> paused;
  std::optional<double> speed;      ///< [1] simulated over real time, > 0; infinity: as fast as the machine allows
  std::uint32_t steps = 0;          ///< ticks to be made while paused
  std::uint32_t dropped_steps = 0;  ///< of those that were asked for before
  std::vector<Joining> joining;
  std::vector<Leaving> leaving;
  std::optional<WorldChange> world;
  bool reset = false;                ///< begins again at time 0, with the same seed
  std::optional<std::int64_t> time;  ///< [ns] of a recording, to go to

  /// Forgets all, and keeps its memory.
  void clear();
  /// Moves all of `later` to the end: what both ask for is what `later` asks for.
  void add(Requests& later);
};

/// Of a run between two ticks.
struct RunState {
  bool paused = false;
  double speed = 1.0;      ///< as in `Requests`
  double measured = 0.0;   ///< [1] simulated over real time, of the last second
  std::uint32_t runs = 0;  ///< number of resets
};

class Bridge {
 public:
  virtual ~Bridge() = default;
  /// Takes one tick; times begin again at 0 after a reset (`RunState::runs`). Copies what it needs, and never waits.
  virtual void publish(const base::TickRecord& tick, const RunState& state) = 0;
  /// Called instead while the run is paused, some 30 times a second. Never waits.
  virtual void publish(const RunState& state) = 0;
  /// Appends requests. Never waits.
  virtual void take(Requests& requests) = 0;
  /// Whether it goes on when its scene changes. Else it is closed before, and another one is opened.
  virtual bool keeps_on() const { return false; }
  /// World, sensor set and info of its scene have more or other movers than before: they were changed in place, between
  /// two ticks. @param is_new it is another world
  virtual void show_scene(bool /*is_new*/) {}
  /// What it is and where, as a line for users: "view on http://127.0.0.1:8765".
  virtual std::string describe() const = 0;
};

/// All bridges of a run.
class Bridges {
 public:
  void add(std::unique_ptr<Bridge> bridge) { bridges_.push_back(std::move(bridge)); }
  /// Closes the bridges for which `condition` holds.
  template <class Condition>
  void remove_if(Condition&& condition) {
    std::erase_if(bridges_, [&](const auto& bridge) { return condition(*bridge); });
  }
  void show_scene(bool is_new);
  bool empty() const { return bridges_.empty(); }

  void publish(const base::TickRecord& tick, const RunState& state);
  void publish(const RunState& state);
  /// Replaces `requests` by all that came since the last call.
  void take(Requests& requests);
  std::vector<std::string> describe() const;

 private:
  std::vector<std::unique_ptr<Bridge>> bridges_;
};

}  // namespace sf::bridges
