#pragma once
// The bridges that a command was asked for.

#include "apps/options.h"
#include "netio/bridges/bridge.h"
#include "record/run_info.h"
#include "scenarios/run_info.h"

namespace sf::apps {

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

  bridges::Bridges& bridges() { return bridges_; }
  bool empty() const { return bridges_.empty(); }

 private:
  record::RunInfo info_;
  bridges::Bridges bridges_;
  bridges::Requests ignored_;
};

}  // namespace sf::apps
