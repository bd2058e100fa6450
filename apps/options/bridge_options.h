#pragma once
// Opens the bridges requested on the command line.

#include "apps/options/options.h"
#include "bridges/bridge.h"
#include "record/run_info.h"
#include "scenarios/run_info.h"
#include "server/drive_relay.h"

namespace sf::apps {

/// Prints notes about topic names that are taken: only the first three, since a fleet may have many.
void print_taken_names(const std::vector<std::string>& notes);

/// The open bridges and the scene they publish. World and sensor set must outlive it.
class LiveBridges : public base::Sink {
 public:
  /// Opens all bridges in `options` and prints their addresses on standard error.
  /// @param simulated see bridges::Scene @param drives of a service, which forwards users' commands; may be null
  /// @throws base::InputError if one cannot be opened
  LiveBridges(const BridgeOptions& options, const world::World& world, const sensors::SensorSet& sensor_set,
              const scenarios::RunSettings& settings, bool simulated, server::DriveRelay* drives = nullptr);

  /// Publishes a tick of a service, which users cannot pause, and forwards commands for robots.
  void write(const base::TickRecord& record) override;

  /// Called before world and sensor set change in place: closes bridges that cannot continue until `show_scene`.
  void prepare_change();
  /// @param is_new true for another world
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
  scenarios::RunSettings settings_;
  const bool simulated_;
  server::DriveRelay* const drives_;
  record::RunInfo info_;
  bridges::Bridges bridges_;
  bridges::Requests requests_;  ///< of a service's users
};

}  // namespace sf::apps
