#pragma once
// The bridges that a command was asked for.

#include "apps/options/options.h"
#include "bridges/bridge.h"
#include "record/run_info.h"
#include "scenarios/run_info.h"

namespace sf::apps {

/// Prints notes of names of topics that are taken: the first three, since a fleet may have many.
void print_taken_names(const std::vector<std::string>& notes);

/// Bridges with what they show. World and sensor set must outlive it.
class LiveBridges : public base::Sink {
 public:
  /// Opens all that `options` name, and says on standard error where they are.
  /// @param simulated see bridges::Scene
  /// @throws base::InputError where one cannot be opened
  LiveBridges(const BridgeOptions& options, const world::World& world, const sensors::SensorSet& sensor_set,
              const scenarios::RunSettings& settings, bool simulated);

  /// Shows a tick of a service, which nobody pauses or drives.
  void write(const base::TickRecord& record) override;

  /// Before world and sensor set change, in place: bridges that cannot go on are closed, until `show_scene`.
  void prepare_change();
  /// @param is_new it is another world
  void show_scene(bool is_new);

  bridges::Bridges& bridges() { return bridges_; }
  bool empty() const { return bridges_.empty(); }

 private:
  void open_ros2();
  void open_player();
  void open_view();

  BridgeOptions options_;  ///< with the ports that were chosen
  const world::World& world_;
  const sensors::SensorSet& sensor_set_;
  const scenarios::RunSettings settings_;
  const bool simulated_;
  record::RunInfo info_;
  bridges::Bridges bridges_;
  bridges::Requests ignored_;
};

}  // namespace sf::apps
