#pragma once
// What goes on in a robot's process: the controller, and all that it is given.

#include <cstdint>
#include <optional>
#include <vector>

#include "apps/options.h"
#include "apps/robot_link.h"
#include "apps/robot_report.h"
#include "apps/stop_signals.h"
#include "base/contact_onset.h"
#include "control/controllers.h"
#include "netio/rate_limited_log.h"
#include "netio/server/wire_ids.h"
#include "scenarios/robot_body.h"
#include "sensors/sensor_set.h"
#include "world/lights.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::apps {

/// By its own option, or by the control shell's setting.
bool waits_for_start(const Options& options);

/// Times are of the robot's own clock [ns], which begins at 0 and does not go back. World, roster and options must
/// outlive it. One thread.
class RobotClient {
 public:
  /// @throws base::InputError for a controller that cannot be had, a port that is taken, a farm's host that is unknown.
  RobotClient(const world::World& world, const sensors::SensorSet& sensor_set, std::uint32_t mover,
              const server::StreamLayout& plan, const Options& options);

  /// Takes in and lets out what comes and is due until `until`, or until a stop is asked for. @param now the clock
  template <class Now>
  void wait_until(std::int64_t until, Now&& now) {
    link_.run(now());
    for (std::int64_t time = now(); time < until && !stop_requested(); time = now()) {
      link_.wait(time, until);
      link_.run(now());
    }
  }

  /// Moves as it decided last, decides anew, and says where it is.
  void step(std::int64_t now);

  /// The last word, after which the farm hears another with this id at once.
  void leave(std::int64_t now) { link_.leave(now); }

  double rate() const { return made_.rate; }  ///< [Hz] of turns
  bool done() const { return started_ && made_.controller->done(); }
  const RobotLink& link() const { return link_; }
  /// All but how long it took.
  RobotReport facts(const Options& options) const;

 private:
  void on_packet(const netio::Packet& packet, std::int64_t now);
  void decide(std::int64_t now);
  void gather_readings();
  void gather_others(std::int64_t now);
  void gather_signals(std::int64_t now);
  /// No reading came for so long that the last one is no ground to drive by.
  bool readings_timed_out(std::int64_t now) const;
  void log_problems(std::int64_t now);

  const world::World& world_;
  server::WireNames names_;
  std::uint32_t mover_;
  scenarios::RobotBody body_;
  RobotLink link_;
  std::optional<world::RoadNetwork> roads_;
  control::ConfiguredController made_;
  std::vector<base::Intent> intents_;  ///< per mover, as told
  base::Twist command_;
  bool started_;
  std::int64_t reading_timeout_;  ///< [ns] without a reading; 0: for ever
  bool problem_logged_ = false;
  bool stands_ = false;      ///< for want of readings
  std::uint64_t stops_ = 0;  ///< times that it came to that
  netio::RateLimitedLog log_;
  std::uint64_t steps_ = 0;
  base::ContactOnset contact_;
  std::uint64_t contacts_ = 0;
  ErrorSummary error_;
  std::vector<base::ReadingBlock> readings_;
  std::vector<control::Neighbour> others_;
  std::vector<world::Signal> signals_;
};

}  // namespace sf::apps
