#pragma once
// Changes of lane use during a run.
//
//   LaneControl lanes(network);
//   lanes.request(lane_named(lanes.base(), "3.1"), {.reversed = true});
//   if (lanes.update(now, reports)) ... *lanes.network() ...      // each tick
//
// A change takes effect at the next tick, except that a lane changes its direction only while it is empty: it is first
// closed, so that no robot enters it, and those in it leave at its end. It opens in its new direction once no robot has
// been on it, or on an exit from or to it, for kClearing. A lane change ends within the clearing time.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/report.h"
#include "world/roads/lane_use.h"

namespace sf::world {

/// Not thread-safe.
class LaneControl {
 public:
  static constexpr std::int64_t kClearing = 2'000'000'000;  ///< [ns]

  explicit LaneControl(const RoadNetwork& base);

  const RoadNetwork& base() const { return *base_; }  ///< as loaded

  /// Requests the use of a lane.
  /// @param lane row in `RoadNetwork::lanes`
  /// @throws base::InputError as `with_uses`, also for uses that other lanes have yet to get
  void request(std::uint32_t lane, const LaneUse& use);

  /// Applies requests.
  /// @param now [ns] does not decrease @param robots absent ones are ignored
  /// @return whether `network` changed
  bool update(std::int64_t now, std::span<const base::Report> robots);

  /// Returns the current network. It never changes; the next one is another object.
  const std::shared_ptr<const RoadNetwork>& network() const { return network_; }
  /// Returns the current uses, one per lane; a lane that is to change its direction is closed.
  std::span<const LaneUse> uses() const { return uses_; }
  /// Returns the use that was requested last.
  const LaneUse& wanted(std::uint32_t lane) const { return wanted_[lane]; }
  /// Returns whether a lane waits to be empty.
  bool is_clearing(std::uint32_t lane) const { return wanted_[lane].reversed != uses_[lane].reversed; }

 private:
  bool is_empty(std::uint32_t lane, std::span<const base::Report> robots) const;

  std::shared_ptr<const RoadNetwork> base_, network_;
  std::vector<LaneUse> wanted_, uses_;                    ///< per lane
  std::vector<std::optional<std::int64_t>> empty_since_;  ///< [ns] per lane, while it is clearing
  bool requested_ = false;                                ///< `wanted_` has changed since the last update
};

}  // namespace sf::world
