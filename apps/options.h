#pragma once
// What the user asked for, as plain values: filled by the command line, read by the commands.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/pose.h"
#include "netio/packets.h"
#include "scenarios/plant.h"
#include "scenarios/tradeoff.h"
#include "sensors/sensor_type.h"
#include "world/world.h"

namespace sf::apps {

enum class Command {
  devices,
  check,
  draw,
  field,
  sense,
  run,
  serve,
  robot,
  start,
  plot,
  listen,
  map,
  experiment,
  test,
  verify,
  explain,
  tradeoff,
  selftest
};

struct Options {
  Command command = Command::devices;
  bool json = false;
  std::string device;  ///< row or part of a name; empty: the best
  std::string caster;  ///< auto, vulkan or host

  std::string world;  ///< world file, or the recording's folder for `plot`
  world::LoadOptions load;
  std::string rndf;  ///< network that `check` holds a mission against; empty: none
  std::string out;   ///< picture, or folder for `plot`

  double height = 0.0;                          ///< [m] of the field's figure
  std::optional<std::array<double, 4>> line;    ///< [m] of its profile: x, y of both ends
  std::optional<std::array<double, 4>> extent;  ///< [m] of its map: x, y of the lower left and upper right corner
  std::string csv;                              ///< file for its profile; empty: none

  std::optional<base::Pose> pose;  ///< of the robot, for `sense`
  std::string robot;
  std::uint8_t kind = 0;     ///< of its sensor; 0: the first it has
  std::uint32_t sensor = 0;  ///< among its sensors of that kind
  bool no_return_inf = false;

  std::string experiment;  ///< by name
  bool list = false;       ///< name them all
  std::uint32_t trials = 3;
  std::optional<scenarios::Plant> plant;  ///< else the experiment's own
  std::string experiments;                ///< folder of their files; empty: found
  std::vector<std::string> scenarios;     ///< files, for `test`
  std::string junit;                      ///< file; empty: none

  scenarios::AccuracyTarget accuracy_target;  ///< for `tradeoff`'s advice, and for `automatic`
  bool automatic = false;                     ///< measure first, and take the modes that the wish comes to

  std::vector<std::string> cases;  ///< of `selftest`, or groups of them; empty: all

  std::uint64_t sample = 500;  ///< scans that `verify` casts again in plain C++; 0: all
  std::uint32_t robots = 0;    ///< clones; 0: the world's own
  std::string of;              ///< robot that they are clones of; empty: the first with sensors
  double duration = 60.0;      ///< [s]; but for `run`, 0 is until stopped
  std::uint64_t seed = 1;
  unsigned threads = 0;
  std::string record;  ///< folder; empty: no recording
  bool record_readings = false;
  bool real_time = false;
  std::string controller = "wander";  ///< who drives
  std::vector<std::string> set;       ///< its settings, "key=value" each
  std::vector<std::string> drive;     ///< whom, by name; empty: every robot
  std::string send;                   ///< host; empty: nobody
  std::string from;                   ///< host that `listen` and `map` take packets from; empty: the first that sends
  sensors::WireFormat wire = sensors::WireFormat::farm;
  std::map<std::uint8_t, std::uint32_t> base_ports;  ///< by sensor kind; every kind is in it
  std::uint32_t ports_per_robot = 0;                 ///< 0: 8, or the least that fits

  std::string bind = "127.0.0.1";
  std::uint32_t port = 9000;
  double rate = 0.0;                 ///< [Hz]; 0: the world's own
  std::string server = "127.0.0.1";  ///< host of the farm, for `robot` and `start`
  double delay = 0.0;                ///< [s] injected between them, in each direction
  double jitter = 0.0;               ///< [s]
  double loss = 0.0;                 ///< [-] in [0, 1]
  bool wait_for_start = false;
  double radio = netio::kV2vRange;  ///< [m] farther away, `serve` passes no states on; 0: it passes none on
  double forget = 10.0;             ///< [s] of silence after which a robot is nobody's obstacle any more; 0: never
  double stop_after = 0.5;          ///< [s] without a reading after which `robot` stands; 0: never
  std::uint32_t start_id = netio::kBroadcastId;  ///< robot to be started
  double silence = 3.0;                          ///< [s] after which `listen` and `map` end

  std::vector<std::uint16_t> map_ports;  ///< that `map` listens on
  bool merge = false;                    ///< of all of them one map
  bool once = false;                     ///< until every port has brought a whole map
};

}  // namespace sf::apps
