#pragma once
// The arguments of each command as plain values. Groups that commands share come first; a command has those that it
// names, and its own.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/pose.h"
#include "netio/packets.h"
#include "netio/ports.h"
#include "scenarios/plant.h"
#include "scenarios/tradeoff.h"
#include "sensors/sensor_type.h"
#include "viz/canvas.h"
#include "world/world.h"

namespace sf::apps {

struct JsonOption {
  bool json = false;
};

struct DeviceOption {
  std::string device;  ///< row or part of a name; empty: the best
};

struct WorldOptions {
  std::string world;  ///< world file
  world::LoadOptions load;
};

struct RecordingOption {
  std::string recording;  ///< its folder
};

struct SeedOption {
  std::uint64_t seed = 1;
};

struct CloneOptions : SeedOption {
  std::uint32_t robots = 0;  ///< clones; 0: the world's own
  std::string of;            ///< robot that they are clones of; empty: the first with sensors
};

struct ThreadsOption {
  unsigned threads = 0;  ///< 0: all
};

struct NoReturnOption {
  bool no_return_inf = false;
};

struct AccuracyTargetOptions {
  scenarios::AccuracyTarget accuracy_target;
  bool automatic = false;  ///< measure first, and take the modes that reach the target
};

struct ControllerOptions {
  std::string controller = "wander";
  std::vector<std::string> set;  ///< its settings, "key=value" each
};

struct WireOption {
  sensors::WireFormat wire = sensors::WireFormat::farm;
};

struct PortOptions : WireOption {
  std::map<std::uint8_t, std::uint32_t> base_ports;  ///< by sensor kind; every kind is in it
  std::uint32_t ports_per_robot = 0;                 ///< 0: 8, or the least that fits
};

struct BindOption {
  std::string bind = "127.0.0.1";
};

struct ReceiveOptions : BindOption {
  std::string from;      ///< host that packets are taken from; empty: the first that sends
  double silence = 3.0;  ///< [s] after which the command ends
};

struct FarmOptions {
  std::string server = "127.0.0.1";  ///< host of the farm
  std::uint32_t port = netio::kInboxPort;
};

struct LinkOptions {
  double delay = 0.0;   ///< [s] injected in each direction
  double jitter = 0.0;  ///< [s]
  double loss = 0.0;    ///< [-] in [0, 1]
};

struct ForgetOption {
  double forget = 10.0;  ///< [s] of silence after which a robot is no obstacle any more; 0: never
};

struct DurationOption {
  double duration = 0.0;  ///< [s]; 0: until stopped
};

struct DevicesOptions : JsonOption, DeviceOption {};

struct CheckOptions : WorldOptions, JsonOption {
  std::string rndf;   ///< network that a mission is checked against; empty: none
  double rate = 0.0;  ///< [Hz] that sensors are compared with; 0: none
};

struct DrawOptions : WorldOptions {
  std::string out;  ///< picture
};

struct FieldOptions : WorldOptions, DeviceOption {
  std::string out;                      ///< picture
  double height = 0.0;                  ///< [m] of the figure
  std::optional<viz::Line> line;        ///< [m] of its profile
  std::optional<world::Extent> extent;  ///< [m] of its map
  std::string csv;                      ///< file for its profile; empty: none
};

struct SenseOptions : WorldOptions, JsonOption, DeviceOption, NoReturnOption {
  std::optional<base::Pose> pose;  ///< of the robot
  std::string robot;               ///< empty: the first that has a sensor
  std::uint8_t kind = 0;           ///< of its sensor; 0: the first it has
  std::uint32_t sensor = 0;        ///< among its sensors of that kind
};

struct PlotOptions : RecordingOption, DeviceOption {
  std::string out;  ///< folder; empty: the recording's
};

struct ExplainOptions : WorldOptions, JsonOption, DeviceOption, CloneOptions, ThreadsOption {};

struct RunOptions : WorldOptions,
                    AccuracyTargetOptions,
                    JsonOption,
                    DeviceOption,
                    CloneOptions,
                    ControllerOptions,
                    NoReturnOption,
                    PortOptions,
                    ThreadsOption {
  std::vector<std::string> drive;  ///< robots that the controller drives, by name; empty: every robot
  double duration = 60.0;          ///< [s]
  std::string record;              ///< folder; empty: no recording
  bool record_readings = false;
  bool real_time = false;
  std::string send;  ///< host; empty: none
};

struct ServeOptions : WorldOptions,
                      AccuracyTargetOptions,
                      JsonOption,
                      DeviceOption,
                      NoReturnOption,
                      PortOptions,
                      BindOption,
                      ForgetOption,
                      SeedOption,
                      DurationOption {
  std::uint32_t port = netio::kInboxPort;  ///< 0: any free one
  double rate = 0.0;                       ///< [Hz]; 0: the world's own
  double radio = netio::kV2vRange;         ///< [m] farther away, states are not relayed; 0: none is
};

struct RobotOptions : WorldOptions,
                      JsonOption,
                      ControllerOptions,
                      FarmOptions,
                      LinkOptions,
                      PortOptions,
                      ForgetOption,
                      SeedOption,
                      DurationOption {
  std::string robot;        ///< its name
  double rate = 0.0;        ///< [Hz]; 0: the controller's own
  double stop_after = 0.5;  ///< [s] without a reading after which it stands; 0: never
  bool wait_for_start = false;
};

struct StartOptions : FarmOptions {
  std::uint32_t start_id = netio::kBroadcastId;  ///< robot to be started
};

struct ListenOptions : WorldOptions, JsonOption, CloneOptions, PortOptions, ReceiveOptions, DurationOption {};

struct MapOptions : ReceiveOptions, WireOption, DurationOption {
  std::vector<std::uint16_t> map_ports;  ///< to listen on
  bool merge = false;                    ///< of all of them one map
  std::string out;                       ///< picture; empty: none
  bool once = false;                     ///< until every port has brought a complete map
};

struct ExperimentOptions : SeedOption, DeviceOption {
  std::string experiment;  ///< by name
  bool list = false;       ///< print all names
  std::string out;         ///< folder
  std::uint32_t trials = 3;
  std::optional<scenarios::Plant> plant;  ///< else the experiment's own
  std::string experiments;                ///< folder of their files; empty: found
};

struct TestOptions : DeviceOption {
  std::vector<std::string> scenarios;  ///< files
  std::string junit;                   ///< file; empty: none
};

struct VerifyOptions : RecordingOption, ThreadsOption, JsonOption, DeviceOption {
  std::uint64_t sample = 500;  ///< scans that are cast again in plain C++; 0: all
};

struct TradeoffOptions : WorldOptions, AccuracyTargetOptions, JsonOption, DeviceOption, CloneOptions, ThreadsOption {
  std::string out;  ///< folder; empty: none
};

struct SelfTestOptions : JsonOption, DeviceOption {
  std::vector<std::string> cases;  ///< or groups of them; empty: all
  bool list = false;               ///< print all cases
};

}  // namespace sf::apps
