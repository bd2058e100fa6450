#pragma once
// Applies faults to readings, after measurement with noise and before delivery.
//
//   Faults faults(world, sensor_set, options.faults, seed, noise, thread_pool);
//   faults.begin();                  // for each tick or sample
//   faults.apply(readings, 0);       // alters them, and removes lost ones
//
// Faults act in the order of their list, each on the result of those before it. Random numbers depend on seed, robot,
// fault and sequence number alone, so results do not depend on threads, reuse or other sensors.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/random.h"
#include "base/reading.h"
#include "base/thread_pool.h"
#include "farm/fault.h"

namespace sf::farm {

/// Not thread-safe.
class Faults {
 public:
  /// @param faults those of unknown robots apply once `add_sensors` has their sensors
  /// @param noise false: sensors have no noise to multiply  @param thread_pool must outlive it
  /// @throws base::InputError as check_faults, except for robots and sensors that do not exist
  Faults(const world::World& world, const sensors::SensorSet& sensor_set, std::vector<Fault> faults, std::uint64_t seed,
         bool noise, base::ThreadPool& thread_pool);

  /// Call this after the world has gained movers.
  void add_sensors(const world::World& world, const sensors::SensorSet& sensor_set);
  bool empty() const { return faults_.empty(); }

  /// Begins a tick or sample: forgets the marks of the last one.
  void begin() { marks_.clear(); }
  /// Applies faults to readings [first, end) and removes the lost ones. Each sensor has one reading at most. Altered
  /// values are valid until the sensor's next reading; they have no bound and an unknown sigma.
  void apply(std::vector<base::ReadingBlock>& readings, std::size_t first);
  /// Does the same for one reading. @return false if it is lost
  bool apply(base::ReadingBlock& reading);

  /// [ns] Returns the additional latency of a reading.
  std::int64_t delay_of(const base::ReadingBlock& reading) const;
  bool delays() const { return delays_; }  ///< any reading may be delayed

  /// Readings affected since `begin`.
  std::span<const base::FaultMark> marks() const { return marks_; }
  const base::FaultCounts& counts() const { return counts_; }

 private:
  /// A fault of one sensor.
  struct Rule {
    std::uint32_t fault = 0;                  ///< row of `faults_`
    std::int64_t from = 0, until = 0;         ///< [ns]
    std::uint32_t offset = 0;                 ///< of its column in a row of values
    std::uint32_t width = 0;                  ///< values of its column; swap: of both
    std::uint32_t other = 0;                  ///< swap: offset of the other column
    double sigma = 0.0;                       ///< noise: deviation to add
    bool whole = false;                       ///< the column is a count
    std::uint32_t channels = 0;               ///< of a colour, 0xRRGGBB: 3, or 1 if it is grey; 0: it is none
    bool is_range = false;                    ///< values stay within the sensor's limits
    std::optional<std::uint32_t> range = {};  ///< offset of the range whose beams without an echo stay
    // Stuck: the last reading that was not affected.
    std::vector<double> values = {};
    std::vector<std::uint32_t> hits = {};
    std::vector<base::QualityFlag> quality = {};
    bool holds = false;
  };
  /// A sensor with faults, and its altered reading.
  struct Target {
    std::vector<Rule> rules = {};
    std::size_t width = 1;  ///< values per row
    base::RangeLimits limits = {};
    std::vector<double> values = {};
    std::vector<std::uint32_t> hits = {};
    std::vector<base::QualityFlag> quality = {};
  };

  Rule rule_of(std::uint32_t fault, const sensors::SensorSet::Group& group, const sensors::SensorSpec& row) const;
  Target* target_of(const base::ReadingBlock& reading);
  const Target* target_of(const base::ReadingBlock& reading) const;
  bool strikes(const Rule& rule, const base::ReadingBlock& reading) const;
  std::uint16_t alter(base::ReadingBlock& reading, Target& target) const;
  bool alter_column(const Rule& rule, const base::ReadingBlock& reading, Target& target) const;
  void swap(const Rule& rule, base::ReadingBlock& reading, Target& target) const;
  bool hold(Rule& rule, base::ReadingBlock& reading, Target& target) const;
  double altered(const Rule& rule, double value, const base::ReadingBlock& reading, std::uint32_t index) const;
  double altered_color(const Rule& rule, double color, const base::ReadingBlock& reading, std::uint32_t index) const;
  bool note(const base::ReadingBlock& reading, std::uint16_t kinds);
  base::RandomKey key(const Rule& rule, const base::ReadingBlock& reading) const;

  std::vector<Fault> faults_;
  std::uint64_t seed_;
  bool noise_;
  base::ThreadPool& thread_pool_;
  bool delays_ = false;
  struct Type {
    std::vector<std::uint32_t> first;    ///< per mover: its first row
    std::vector<std::uint32_t> targets;  ///< per row: index in `targets_` plus one; 0: none
  };
  std::vector<Type> types_;  ///< by wire id; without targets: no faults
  std::vector<Target> targets_;
  std::vector<std::uint16_t> kinds_;  ///< scratch: per reading
  std::vector<base::FaultMark> marks_;
  base::FaultCounts counts_{};
};

}  // namespace sf::farm
