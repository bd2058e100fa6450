#pragma once
// Bridges connect a run or a service to external programs: viewers, ROS 2, clients of Player. Each tick is published to
// all bridges, and requests of their users are collected before the next tick:
//
//   bridges.publish(simulation.step(), state);
//   bridges.take(requests);
//
// A bridge does its input and output on its own thread. A slow or hostile client loses readings but never delays a
// tick.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/pose.h"
#include "base/tick_record.h"
#include "record/run_info.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::bridges {

/// The parts of a run. All three references outlive its bridges.
struct Scene {
  const world::World& world;
  const sensors::SensorSet& sensor_set;
  const record::RunInfo& info;  ///< with frames and topics (`record::name_frames`); movers are rows of the world's
  bool simulated = true;        ///< whether the simulation moves robots and accepts commands; false: `serve`
  std::vector<std::string> world_folders = {};  ///< whose worlds users may load; empty: none
};

/// The outcome of a request that the run may refuse. Written before the next `publish`.
struct Outcome {
  enum class Fault : std::uint8_t { none, failed, unreadable, unsupported };
  bool done = false;
  Fault fault = Fault::none;
  std::string reason;  ///< of a fault
};

/// A robot that joins as a copy of another.
struct Joining {
  std::string name, like;  ///< see world::append_robot
  base::Pose X_WM;         ///< finite
  std::shared_ptr<Outcome> outcome;
};

struct Leaving {
  std::uint32_t mover = 0;
  std::shared_ptr<Outcome> outcome;
};

/// A world to continue with, from time 0, paused.
struct WorldChange {
  std::string file;     ///< empty: an empty world
  bool strict = false;  ///< whether files with warnings are refused
  std::shared_ptr<Outcome> outcome;
};

/// The velocity of a mover in its own frame. Applies until the next command.
struct Command {
  std::uint32_t mover = 0;
  base::Twist twist;  ///< finite
};

struct Placement {
  std::uint32_t mover = 0;
  base::Pose X_WM;  ///< finite
  base::Tilt tilt = {};
};

/// User requests since the last call, in order of arrival. Bridges reject requests that name no mover or contain
/// numbers that are not finite, and all requests if robots are not simulated.
struct Requests {
  std::vector<Command> commands;  ///< from its first command on, a robot is driven externally, not by its controller
  std::vector<Placement> placements;
  std::optional<bool> paused;
  std::optional<double> speed;      ///< [1] simulated over real time, > 0; infinity: as fast as the machine allows
  std::uint32_t steps = 0;          ///< ticks to simulate while paused
  std::uint32_t dropped_steps = 0;  ///< of earlier requested steps
  std::vector<Joining> joining;
  std::vector<Leaving> leaving;
  std::optional<WorldChange> world;
  bool reset = false;                ///< restarts at time 0 with the same seed
  std::optional<std::int64_t> time;  ///< [ns] time in a recording to jump to

  /// Clears all requests and keeps the memory.
  void clear();
  /// Moves all of `later` to the end; its values override earlier ones.
  void add(Requests& later);
};

/// State of a run between two ticks.
struct RunState {
  bool paused = false;
  double speed = 1.0;      ///< as in `Requests`
  double measured = 0.0;   ///< [1] simulated over real time, during the last second
  std::uint32_t runs = 0;  ///< number of resets
};

class Bridge {
 public:
  virtual ~Bridge() = default;
  /// Shows the robots' intents of one tick. Called before `publish` of the same tick. Copies the intents.
  /// @param intents by row of the mover
  virtual void show_intents(std::span<const base::Intent> /*intents*/) {}
  /// Publishes one tick. Times restart at 0 after a reset (`RunState::runs`). Copies what it needs and never blocks.
  virtual void publish(const base::TickRecord& tick, const RunState& state) = 0;
  /// Called instead while the run is paused, about 30 times a second. Never blocks.
  virtual void publish(const RunState& state) = 0;
  /// Appends requests. Never blocks.
  virtual void take(Requests& requests) = 0;
  /// Returns whether the bridge remains open when its scene changes. Otherwise it is closed first, and a new one is
  /// opened.
  virtual bool keeps_on() const { return false; }
  /// Called when the movers in the world, sensor set and info of its scene have changed. They were changed in place,
  /// between two ticks.
  /// @param is_new whether it is another world
  virtual void show_scene(bool /*is_new*/) {}
  /// Returns a line for users with its kind and address: "view on http://127.0.0.1:8765".
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
  void show_intents(std::span<const base::Intent> intents);
  bool empty() const { return bridges_.empty(); }

  void publish(const base::TickRecord& tick, const RunState& state);
  void publish(const RunState& state);
  /// Replaces `requests` by all requests since the last call.
  void take(Requests& requests);
  std::vector<std::string> describe() const;

 private:
  std::vector<std::unique_ptr<Bridge>> bridges_;
};

}  // namespace sf::bridges
