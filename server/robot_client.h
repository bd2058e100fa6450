#pragma once
// A robot's process without its command line: the controller, its inputs, and the loop that runs them.

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/contact_onset.h"
#include "base/pose.h"
#include "control/controllers.h"
#include "control/error_summary.h"
#include "control/remote.h"
#include "robots/robot_body.h"
#include "sensors/sensor_set.h"
#include "server/lane_service.h"
#include "server/light_listener.h"
#include "server/map_exchange.h"
#include "server/own_map.h"
#include "server/own_state.h"
#include "server/real_robot.h"
#include "server/robot_client_log.h"
#include "server/robot_link.h"
#include "server/simulated_sensors.h"
#include "server/truth_report.h"
#include "server/wire_ids.h"
#include "world/lights.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::server {

struct RobotClientOptions {
  LinkOptions link;
  control::ControllerConfig controller;
  std::uint64_t seed = 1;
  double forget = 10.0;                 ///< [s] of silence after which another robot is no longer an obstacle; 0: never
  double stop_after = 0.5;              ///< [s] without a reading after which the robot stops; 0: never
  bool stop_without_farm = false;       ///< `stop_after` also with a controller that does not need these readings
  bool wait_for_start = false;          ///< stays at rest until the start signal arrives
  int log_descriptor = 2;               ///< of its log; -1: no log
  std::optional<netio::Endpoint> spat;  ///< where to receive SPaT of traffic lights, in place of the farm's V2I
  std::function<std::int64_t()> utc;    ///< [ms] since 1970; empty: the system clock
  std::uint32_t tag = 0;                ///< id of the tag carried below cameras; 0: same as the robot
  /// Cameras that see its tag, whose poses its state is estimated from. The tag is that of `tag`.
  std::optional<CameraOptions> cameras;
  /// [m] > 0 standard deviation of its position at which it stops; nullopt: 0.5 with cameras, which can find it again,
  /// else none.
  std::optional<double> most_sigma;
  /// Where to report its true state as V2V packets with its tag's id, 50 per second, stamped with Unix time; nullopt:
  /// nowhere. Replaces the light that cameras see.
  std::optional<netio::Endpoint> truth;
  std::optional<RealRobotOptions> real;  ///< robot that moves in place of the model; nullopt: none
  bool shares_readings = true;           ///< sends the real robot's own readings to the farm, which fuses them
  std::optional<OwnMapOptions> map;      ///< where to send its own map; nullopt: no map
};

/// Statistics of the estimates of its own state.
struct OwnStateStats {
  bool cameras = false;
  bool wheels = false;
  bool gyro = false;
  bool gps = false;
  OwnStateCounts counts;
  control::LocalizationError errors;    ///< of a simulated robot, at its steps that were not lost
  double sigma = 0.0;                   ///< [m] standard deviation of the position, at the end; infinite: never located
  estimation::Calibration calibration;  ///< at the end
};

/// Statistics of a real robot.
struct RealRobotStats {
  std::string type;  ///< word of its RealRobotType
  RealRobotCounts counts;
  std::vector<RobotFact> facts;                                ///< as last reported
  std::map<std::string, std::uint64_t, std::less<>> readings;  ///< of its own sensors, by sensor type
};

/// Statistics of a robot's process.
struct RobotClientStats {
  std::string robot;  ///< name in the world file
  std::uint32_t id = 0;
  std::string controller;
  std::string farm;  ///< "127.0.0.1:9000"
  double wall_s = 0.0;
  std::uint64_t steps = 0;  ///< of the controller
  bool started = true;      ///< no start signal was required, or it arrived
  bool done = false;        ///< as reported by the controller
  std::string stop_reason;  ///< of the controller, if it stands still at the end; empty: it drives, or states none
  bool answered = false;    ///< a packet arrived from the farm
  bool listens = true;      ///< it has sensors and therefore expects packets; false if its controller needs no readings
                            ///< and it received states of others directly
  LinkCounts link;
  std::uint64_t contacts = 0;  ///< number of contacts that began
  std::uint64_t stops = 0;     ///< number of stops for lack of readings or positions
  DroppedReadings dropped;
  std::uint64_t lines_left_out = 0;  ///< dropped from its log
  double distance_m = 0.0;           ///< distance driven
  base::Pose pose;                   ///< at the end
  control::ErrorSummary error;
  std::optional<OwnStateStats> own;       ///< nullopt: drives by its true state
  std::optional<RealRobotStats> real;     ///< nullopt: simulated robot
  std::optional<OwnMapCounts> map;        ///< nullopt: no map
  std::optional<MapExchangeCounts> team;  ///< nullopt: shares no map with a team
  bool listens_for_spat = false;
  LightCounts lights;
  std::uint64_t drives = 0;          ///< DRIVE packets of the farm that it followed
  std::uint64_t drives_ignored = 0;  ///< DRIVE packets received by another controller than `remote`
};

/// Times [ns] are on the robot's own monotonic clock, which starts at 0. The world and the sensor set must outlive it.
/// Not thread-safe.
class RobotClient {
 public:
  /// @throws base::InputError for an unavailable controller, a tag without an id, a port in use, or an unknown host of
  /// the farm
  RobotClient(const world::World& world, const sensors::SensorSet& sensor_set, std::uint32_t mover,
              const StreamLayout& layout, const RobotClientOptions& options);

  /// Steps at its rate by the system clock, or on each new scan (ControllerType::on_scans), until `stop` is set, the
  /// controller is done, or `duration` [s] have passed (0: no limit). Then leaves.
  void run(const std::atomic<bool>& stop, double duration);

  /// Processes received packets and releases delayed ones, in both directions.
  void receive(std::int64_t now);

  /// Moves by the last command and reports the true state. `step` includes this; calls between steps make the reported
  /// truth finer.
  void move(std::int64_t now);
  /// Returns whether the next step is due, by its rate or because a new scan has arrived.
  bool is_due(std::int64_t now) const { return now >= next_ || (made_.on_scans && link_.scans() > scans_); }
  /// Executes the last command until `now`, computes the next one, and sends its state.
  void step(std::int64_t now);

  /// Sends the last packet, after which the farm immediately accepts another process with this id.
  void leave(std::int64_t now);

  double rate() const { return made_.rate; }        ///< [Hz] of steps
  bool on_scans() const { return made_.on_scans; }  ///< steps on each new scan, or at half its rate without scans
  /// Returns whether the controller is done, and its team has its map.
  bool done() const { return started_ && made_.controller->done() && !owes_map_; }
  const RobotLink& link() const { return link_; }
  const RealRobot* real() const { return real_.get(); }            ///< null: the body is a model
  const OwnState* own() const { return own_ ? &*own_ : nullptr; }  ///< null: drives by its true state
  const LightListener& lights() const { return lights_; }
  RobotClientStats stats() const;

 private:
  using Clock = std::function<std::int64_t()>;
  void wait_until(std::int64_t until, const std::atomic<bool>& stop, const Clock& clock);
  std::int64_t next_step(std::int64_t now) const;
  void on_packet(const netio::Packet& packet, std::int64_t now);
  void decide(std::int64_t now);
  bool is_blind(std::int64_t now) const;
  bool needs_farm(std::int64_t now) const;
  void take_drive(const netio::Drive& drive, std::int64_t now);
  void send_state(std::int64_t now);
  /// Own state as estimated by the robot.
  const base::Report& own_state() const { return own_ ? own_->state() : body_.state(); }
  void gather_readings(std::int64_t now);
  void gather_own_readings(std::int64_t now);
  void send_own_readings(std::int64_t now);
  void gather_others(std::int64_t now);
  void gather_signals(std::int64_t now);
  /// Returns whether its state is unknown, or too uncertain to act on.
  bool is_lost() const { return own_ && own_->is_lost(); }
  void add_own_state(const RobotClientOptions& options);
  void update_real(std::int64_t now);
  void follow_real(std::int64_t now);
  void set_outputs(std::uint8_t bits, std::int64_t now);
  void draw_map(std::int64_t now);
  void add_team();
  void send_maps(std::int64_t now);

  const world::World& world_;
  const sensors::SensorSet& sensor_set_;
  WireNames names_;
  std::uint32_t mover_;
  robots::RobotBody body_;
  std::optional<world::RoadNetwork> roads_;
  LightListener lights_;
  ReceivedLanes lanes_;
  RobotLink link_;
  control::ConfiguredController made_;
  std::uint64_t needs_ = 0;            ///< control::Controller::needs, unless it stops without the farm
  std::vector<base::Intent> intents_;  ///< last received, per mover
  base::Twist command_;
  bool started_;
  RobotClientLog log_;
  std::uint64_t steps_ = 0;
  std::uint64_t scans_ = 0;  ///< arrived by the last step
  std::int64_t next_ = 0;    ///< [ns] of the next step by its rate
  base::ContactOnset contact_;
  std::uint64_t contacts_ = 0;
  control::ErrorSummary error_;
  std::string controller_;  ///< its name
  double wall_s_ = 0.0;
  std::vector<base::ReadingBlock> readings_;
  std::vector<control::Neighbour> others_;
  std::vector<world::Signal> signals_;
  std::function<std::int64_t()> utc_;
  std::optional<OwnState> own_;                        ///< empty: drives by its true state
  std::optional<SimulatedSensors> simulated_sensors_;  ///< by which a simulated robot localizes itself
  control::LocalizationError position_errors_;
  std::optional<TruthReport> truth_;
  std::int64_t epoch_ = 0;           ///< [ns] Unix time at time 0 of its clock, set in `run`
  std::unique_ptr<RealRobot> real_;  ///< null: the body is a model
  bool shares_readings_;
  /// By type and number: own readings processed by `send_own_readings`.
  std::map<std::pair<std::uint8_t, std::uint16_t>, std::uint32_t> shared_;
  double track_ = 0.0;                     ///< [m] of the real robot's wheels, as estimated from
  bool touched_ = false;                   ///< the real robot had a contact since the last step
  std::optional<OwnMap> map_;              ///< empty: no map
  control::SharesMap* sharing_ = nullptr;  ///< of `made_`; null: shares no map
  bool owes_map_ = false;                  ///< a teammate lacks a part of the map, as of the last step
  std::optional<MapExchange> exchange_;    ///< of `sharing_`; empty: no V2V without the farm
  control::Remote* remote_ = nullptr;      ///< of `made_`; null: another controller
  std::uint64_t drives_ = 0, drives_ignored_ = 0;
};

}  // namespace sf::server
