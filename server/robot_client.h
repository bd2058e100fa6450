#pragma once
// A robot's process without its command line: the controller, its inputs, and the loop around both.

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/contact_onset.h"
#include "base/pose.h"
#include "control/controllers.h"
#include "control/error_summary.h"
#include "control/own_localization.h"
#include "robots/robot_body.h"
#include "sensors/sensor_set.h"
#include "server/camera_positions.h"
#include "server/create_drive.h"
#include "server/light_listener.h"
#include "server/own_map.h"
#include "server/robot_client_log.h"
#include "server/robot_link.h"
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
  double forget = 10.0;                 ///< [s] of silence after which another robot is no obstacle any more; 0: never
  double stop_after = 0.5;              ///< [s] without a reading after which it stands; 0: never
  bool wait_for_start = false;          ///< it stands until the start signal comes
  int log_descriptor = 2;               ///< of its log's lines; -1: none
  std::optional<netio::Endpoint> spat;  ///< where it listens for SPaT of traffic lights, in place of the farm's V2I
  std::function<std::int64_t()> utc;    ///< [ms] since 1970; empty: the machine's clock
  std::uint32_t tag = 0;                ///< that it carries, below cameras; 0: the one with the robot's id
  /// Its own pose, and that in its packets to the farm, come from cameras alone; nullopt: it knows its true pose.
  std::optional<CameraPositionsOptions> cameras;
  /// Where it reports its true state as V2V packets with its tag's id, 50 a second, stamped with Unix time; nullopt:
  /// nowhere. It stands for the light that cameras see.
  std::optional<netio::Endpoint> truth;
  std::optional<CreateOptions> create;  ///< a real robot, which moves in place of the model; nullopt: none
  std::optional<OwnMapOptions> map;     ///< where it sends its own map; nullopt: it makes none
};

/// Positions from cameras.
struct CameraPositionsStats {
  netio::PacketCounts packets;
  StateFilterCounts states;
  PositionErrors errors;  ///< of its own fresh states at its steps
};

/// How a robot's process went.
struct RobotClientStats {
  std::string robot;  ///< name in the world
  std::uint32_t id = 0;
  std::string controller;
  std::string farm;  ///< "127.0.0.1:9000"
  double wall_s = 0.0;
  std::uint64_t steps = 0;  ///< of the controller
  bool started = true;      ///< it did not wait for a start signal, or it came
  bool done = false;        ///< as the controller says
  bool answered = false;    ///< anything came from the farm
  bool listens = true;      ///< it has sensors, so that something should have come
  LinkCounts link;
  std::uint64_t contacts = 0;        ///< that began
  std::uint64_t stops = 0;           ///< times that it stood for want of readings or positions
  std::uint64_t lines_left_out = 0;  ///< of its log
  double distance_m = 0.0;           ///< driven
  base::Pose pose;                   ///< at the end
  control::ErrorSummary error;
  std::optional<CameraPositionsStats> cameras;  ///< nullopt: it knows its true pose
  control::LocalizationError localization;      ///< beside the poses of its motion model
  std::optional<CreateCounts> create;           ///< nullopt: no real robot
  std::optional<OwnMapCounts> map;              ///< nullopt: it makes none
  bool listens_for_spat = false;
  LightCounts lights;
};

/// Times are of the robot's own clock [ns], which begins at 0 and does not go back. World and sensor set must outlive
/// it. One thread.
class RobotClient {
 public:
  /// @throws base::InputError for a controller that cannot be had, a tag without an id, a port that is taken, a farm's
  /// host that is unknown.
  RobotClient(const world::World& world, const sensors::SensorSet& sensor_set, std::uint32_t mover,
              const StreamLayout& layout, const RobotClientOptions& options);

  /// Steps at its rate by the machine's clock, or on each new scan (ControllerType::on_scans), until `stop` is set, the
  /// controller is done, or `duration` [s] have passed (0: without end); then leaves.
  void run(const std::atomic<bool>& stop, double duration);

  /// Takes what came, and lets go what is due in both directions.
  void receive(std::int64_t now);

  /// Moves as it decided last, and reports the truth. `step` does it too; between steps it makes the truth finer.
  void move(std::int64_t now);
  /// The next step is due: by its rate, or because a new scan has arrived.
  bool is_due(std::int64_t now) const { return now >= next_ || (made_.on_scans && link_.scans() > scans_); }
  /// Executes the last command until `now`, decides, and sends its state.
  void step(std::int64_t now);

  /// The last packet, after which the farm accepts another process with this id at once.
  void leave(std::int64_t now);

  double rate() const { return made_.rate; }  ///< [Hz] of steps
  bool on_scans() const {
    return made_.on_scans;
  }  ///< steps on each new scan, in the absence of scans at half its rate
  bool done() const { return started_ && made_.controller->done(); }
  const RobotLink& link() const { return link_; }
  const CameraPositions* cameras() const { return cameras_ ? &*cameras_ : nullptr; }  ///< null: it has none
  const LightListener& lights() const { return lights_; }
  RobotClientStats stats() const;

 private:
  using Clock = std::function<std::int64_t()>;
  void wait_until(std::int64_t until, const std::atomic<bool>& stop, const Clock& clock);
  std::int64_t next_step(std::int64_t now) const;
  void on_packet(const netio::Packet& packet, std::int64_t now);
  void decide(std::int64_t now);
  void send_state(std::int64_t now);
  /// As it knows it.
  const base::Report& own_state() const { return cameras_ ? cameras_->state() : body_.state(); }
  void gather_readings();
  void gather_others(std::int64_t now);
  void gather_signals(std::int64_t now);
  /// No camera saw it for so long that its state is no ground to drive by.
  bool is_lost() const { return cameras_ && !cameras_->is_fresh(); }
  void draw_map(std::int64_t now);

  const world::World& world_;
  WireNames names_;
  std::uint32_t mover_;
  robots::RobotBody body_;
  std::optional<world::RoadNetwork> roads_;
  LightListener lights_;
  RobotLink link_;
  control::ConfiguredController made_;
  std::vector<base::Intent> intents_;  ///< per mover, as told
  base::Twist command_;
  bool started_;
  RobotClientLog log_;
  std::uint64_t steps_ = 0;
  std::uint64_t scans_ = 0;  ///< that had arrived at the last step
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
  std::optional<CameraPositions> cameras_;
  PositionErrors position_errors_;
  std::optional<TruthReport> truth_;
  std::int64_t epoch_ = 0;             ///< [ns] Unix time at time 0 of its clock, in `run`
  std::optional<CreateDrive> create_;  ///< none: the body is a model
  std::optional<OwnMap> map_;          ///< none: it makes no map
};

}  // namespace sf::server
