#pragma once
// Evaluates the derived sensors of a world from the readings that are delivered.
//
//   DerivedSensors derived(world, sensor_set, thread_pool);
//   derived.want(subscribed);                          // whenever subscriptions change
//   readings = derived.evaluate(now, delivered, due);  // for each tick and sample
//
// Sensors are evaluated level by level, a level's in parallel, so results do not depend on the number of threads. Each
// sensor processes the readings delivered since its last call in order of measurement time, then of input, so they do
// not depend on the order of arrival either.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "base/thread_pool.h"
#include "sensors/derived/wiring.h"
#include "sensors/sensor_set.h"

namespace sf::sensors {

/// Not thread-safe.
class DerivedSensors {
 public:
  /// All arguments must outlive it.
  DerivedSensors(const world::World& world, const SensorSet& sensor_set, base::ThreadPool& thread_pool,
                 const raycast::Episodes& episodes = {});

  bool empty() const { return nodes_.empty(); }
  std::span<const DerivedNode> nodes() const { return wired_; }

  /// Sets the sensors to evaluate: those subscribed and those that are inputs of others. A sensor that was not
  /// evaluated before starts over, with the next call of `evaluate`. @param subscribed per mover  @param gone per
  /// mover; 1: absent, so none of its sensors is an input. Empty: none is
  void want(std::span<const base::SensorTypes> subscribed, std::span<const std::uint8_t> gone = {});
  /// Wants one sensor and its inputs, until the next call of `want`.
  void want_only(std::uint32_t mover, std::uint8_t type, std::uint32_t sensor);
  /// Returns per sensor of group `group` of the sensor set whether it is an input of an evaluated sensor; empty: none.
  std::span<const std::uint8_t> needed(std::size_t group) const { return needed_[group]; }

  /// Delivery of a new reading: sensors on higher levels receive only delivered ones in the same call.
  enum class Fate : std::uint8_t { delivered, late, lost };
  /// Called once for each reading, before other sensors take it; may alter it. Empty: sensors without latency deliver.
  using Stage = std::function<Fate(base::ReadingBlock& reading)>;

  /// @param delivered readings delivered at `now` [ns], in any order
  /// @param due per derived group of the sensor set, in order: its due sensors
  /// @param states per mover @param commands per mover: the twists executed since the last tick; NaN, or empty: none
  /// @param received readings of other pseudo-types (`is_received`); `sensor` of a `v2v`: row of the receiving mover
  /// @return readings of the due sensors that are not lost, by type and row, except that latency is not applied; valid
  /// until the next call
  /// @throws base::InputError when a sensor throws an exception
  std::span<const base::ReadingBlock> evaluate(std::int64_t now, std::span<const base::ReadingBlock> delivered,
                                               std::span<const std::span<const DueSample>> due,
                                               std::span<const base::Report> states, const Stage& stage = {},
                                               std::span<const base::Twist> commands = {},
                                               std::span<const base::ReadingBlock> received = {});

  /// Resets the sensors of movers [first, end); the next call of `evaluate` creates them, at the poses of that call.
  void restart(std::uint32_t first, std::uint32_t end);
  /// Returns "none of the 30 readings of gps 'a' of 'r0' was valid" for each sensor of which that is true, by level.
  std::vector<std::string> never_valid() const;

  /// Continues the sensors of `before`, a world with fewer movers in its first rows. `before` must not be used
  /// afterwards.
  void take_over(DerivedSensors& before);

 private:
  struct Pending {
    std::int64_t time;
    std::uint32_t input, sequence;
    const base::ReadingBlock* reading;
    auto key() const { return std::tuple(time, input, sequence); }
  };
  struct Node {
    std::unique_ptr<sensorfarm::DerivedSensor> sensor;  ///< null: not evaluated
    std::vector<Pending> pending;
    std::string name;  ///< for messages
    std::vector<double> quantities, covariance;
    std::vector<std::uint8_t> valid;
    std::vector<double> values;  ///< of the reading: the three above, row by row
    std::string failure;
    std::uint32_t sequence = 0;
    std::uint64_t readings = 0;  ///< since the start
    bool was_valid = false;      ///< one of their rows
    bool is_due = false;
    bool is_lost = false;  ///< its last reading
    bool active = false;
    bool wanted = false;
    bool starts = true;  ///< with the next call of `evaluate`, an episode
  };
  struct Listener {
    std::uint32_t node, input;
  };
  template <class Wanted>
  void want_if(const Wanted& wanted, std::span<const std::uint8_t> gone = {});
  void create_wanted(std::span<const base::Report> states);
  void route(const base::ReadingBlock& reading);
  void take_commands(std::int64_t now, std::span<const base::Twist> commands);
  void take_received(const base::ReadingBlock& reading);
  void add_pending(std::size_t node, const Pending& pending);
  void process(std::size_t node, std::int64_t now);
  void call(std::size_t node, std::int64_t now);
  void run_level(std::size_t level, std::int64_t now, std::span<const base::Report> states, const Stage& stage);

  const world::World& world_;
  const SensorSet& sensor_set_;
  base::ThreadPool& thread_pool_;
  raycast::Episodes episodes_;
  std::vector<DerivedNode> wired_;
  std::vector<Node> nodes_;                                    ///< like `wired_`
  std::vector<std::vector<std::size_t>> levels_;               ///< nodes by level
  std::vector<std::vector<std::uint8_t>> needed_;              ///< per group and row
  std::vector<std::vector<std::vector<Listener>>> listeners_;  ///< per group and row
  struct Command {
    std::array<double, 3> values;
    base::ReadingBlock reading;
  };
  struct ReceivedListener {
    std::uint8_t type;  ///< a pseudo-type
    std::uint32_t mover;
    Listener listener;
  };
  std::vector<ReceivedListener> received_listeners_;
  std::vector<Command> commands_;               ///< like `received_listeners_`
  std::vector<int> group_of_;                   ///< by wire id; -1: none
  std::vector<const SensorType*> input_types_;  ///< by wire id
  std::vector<std::size_t> due_nodes_;
  std::vector<std::vector<std::size_t>> active_;  ///< per level: nodes with pending readings, or due
  std::vector<base::ReadingBlock> blocks_;        ///< per node
  std::vector<base::ReadingBlock> out_;
  bool demand_changed_ = false;  ///< since `create_wanted`
  bool starting_ = true;         ///< some nodes start with the next call of `evaluate`
};

/// Wires and creates all derived sensors of a world once. @throws base::InputError for invalid wiring or settings
void check_derived_sensors(const world::World& world, const SensorSet& sensor_set);

}  // namespace sf::sensors
