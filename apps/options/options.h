#pragma once
// The arguments of each command as plain values. Groups shared by several commands come first; a command derives from
// its groups and adds its own options.

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/options/tilted_pose.h"
#include "apps/reports/camera_image.h"
#include "base/pose.h"
#include "bridges/web_access.h"
#include "netio/packets.h"
#include "netio/ports.h"
#include "record/mcap.h"
#include "record/topic_names.h"
#include "robots/estimation/sender_clock.h"
#include "robots/estimation/track_filter.h"
#include "scenarios/plant.h"
#include "scenarios/tradeoff.h"
#include "sensors/sensor_type.h"
#include "server/light_listener.h"
#include "viz/interval_figure.h"
#include "viz/paths.h"
#include "viz/picture_file.h"
#include "world/world.h"

namespace sf::apps {

struct JsonOption {
  bool json = false;
};

struct DeviceOption {
  std::string device;           ///< row or part of a name, or gpu::kHostDevice; empty: the best device
  bool require_vulkan = false;  ///< do not fall back to the host
};

struct InProcessOption {
  bool in_process = false;  ///< users' code runs in this process instead of a child process
};

struct WorldOptions {
  std::string world;       ///< world file
  std::string robot_from;  ///< "FILE:NAME" of the robot that a world without one is lent; empty: the default
  world::LoadOptions load;
};

struct RecordingOption {
  std::string recording;  ///< its folder
};

struct PageOption {
  viz::Page page;
};

struct CompressionOption {
  record::Compression compression = record::Compression::zstd;  ///< of recordings
};

struct ImagesOption {
  record::ImageMessages images;  ///< of recordings and bridges
};

/// A video of a run, or its frames.
struct VideoOptions {
  std::string video;                           ///< file; empty: none
  std::string frames;                          ///< folder for PNG files instead of a video; empty: none
  int video_fps = 25;                          ///< [Hz] frames per second of video
  double video_speed = 1.0;                    ///< [1] simulated time per video time
  int video_width = 1280, video_height = 720;  ///< [px] even
  std::optional<world::Extent> video_extent;   ///< [m] area shown at least; nullopt: the whole world
  std::vector<std::string> video_follow;       ///< robots that the camera follows; empty: the camera does not move
  double video_around = 5.0;                   ///< [m] margin around them
  std::vector<std::string> video_readings;     ///< robots whose ranges are drawn
  std::string video_camera;                    ///< "ROBOT" or "ROBOT:CAMERA" of a recording, whose images are shown
                                               ///< instead of the world; empty: none
};

/// The part of a recording that a command processes.
struct PartOption {
  std::vector<std::string> robots;  ///< names; empty: all
  double from = 0.0;                ///< [s] simulated
  double to = HUGE_VAL;             ///< [s] simulated
};

struct SeedOption {
  std::uint64_t seed = 1;
};

struct CloneOptions : SeedOption {
  std::uint32_t robots = 0;  ///< clones; 0: the world's own robots
  std::string of;            ///< robot to clone; empty: the first with sensors
};

struct ThreadsOption {
  unsigned threads = 0;  ///< 0: all
};

struct NoReturnOption {
  bool no_return_inf = false;
  bool too_near_min = false;  ///< in packets and CSV
};

struct AccuracyTargetOptions {
  scenarios::AccuracyTarget accuracy_target;
  bool automatic = false;  ///< measure first and use the modes that reach the target
};

struct ControllerOptions : InProcessOption {
  std::string controller = "wander";
  bool controller_given = false;  ///< on the command line: overrides `ctrl` of the world file
  std::vector<std::string> set;   ///< its settings, "key=value" each
  std::optional<bool> localize;   ///< see the setting of this name
};

struct WireOption {
  sensors::WireFormat wire = sensors::WireFormat::farm;
};

struct PortOptions : WireOption {
  std::map<std::uint8_t, std::uint32_t> base_ports;  ///< by sensor type; contains every type
  std::uint32_t ports_per_robot = 0;                 ///< 0: 8, or the smallest number that suffices
};

struct BindOption {
  std::string bind = "127.0.0.1";
};

struct ReceiveOptions : BindOption {
  std::string from;      ///< host from which packets are accepted; empty: the first that sends
  double silence = 3.0;  ///< [s] without packets after which the command ends
};

struct FarmOptions {
  std::string server = "127.0.0.1";  ///< host of the farm
  std::uint32_t port = netio::kInboxPort;
};

struct LinkOptions {
  double delay = 0.0;      ///< [s] injected in each direction
  double jitter = 0.0;     ///< [s]
  double loss = 0.0;       ///< [-] in [0, 1]
  double duplicate = 0.0;  ///< [-] in [0, 1]
  double corrupt = 0.0;    ///< [-] in [0, 1]
};

struct ForgetOption {
  double forget = 10.0;  ///< [s] without packets after which a robot is no longer an obstacle; 0: never
};

/// For the states that robots and cameras send.
struct FilterOptions {
  bool filter = false;
  bool raw = false;
  estimation::ClockSource clock = estimation::ClockSource::estimated;
  double link_delay = 0.0;                       ///< [s] minimum link delay, for clock estimates
  bool unix_time = true;                         ///< neither `clock` nor `link_delay` was given
  double stale_after = 1.0;                      ///< [s] without an accepted state
  std::optional<estimation::StalePolicy> stale;  ///< nullopt: hide; freeze with `raw`
  std::size_t hypotheses = 16;                   ///< > 0; for a state with an uncertain heading
  bool keep_heights = false;
};

struct PeersOption {
  std::string peers;  ///< file of addresses and keys; empty: none
};

struct DurationOption {
  double duration = 0.0;  ///< [s]; 0: until stopped
};

/// Position of the world's origin on the Earth.
struct OriginOption {
  double latitude = 0.0;   ///< [deg] in [-89, 89]
  double longitude = 0.0;  ///< [deg] in [-180, 180]
};

struct DevicesOptions : JsonOption, DeviceOption {};

struct CheckOptions : WorldOptions, JsonOption {
  std::string rndf;   ///< network to check a mission against; empty: none
  double rate = 0.0;  ///< [Hz] rate that the sensors are compared with; 0: none
};

struct DrawOptions : WorldOptions, PageOption {
  std::string out;  ///< picture file
};

struct V2xOptions : OriginOption {
  std::string file;  ///< "-": standard input
  enum class Action { decode, encode, export_world };
  Action action = Action::decode;
  bool xml = false;   ///< decode to XML
  double time = 0.0;  ///< [s] for export: simulated time
};

struct FieldOptions : WorldOptions, DeviceOption, PageOption {
  std::string out;                      ///< picture file
  double height = 0.0;                  ///< [m] of the figure
  std::optional<viz::Line> line;        ///< [m] of its profile
  std::optional<world::Extent> extent;  ///< [m] of its map
  std::string csv;                      ///< file for its profile; empty: none
};

struct SenseOptions : WorldOptions, JsonOption, DeviceOption, NoReturnOption {
  std::optional<TiltedPose> pose;  ///< of the robot
  std::string robot;               ///< empty: the first robot that has a sensor
  std::uint8_t type = 0;           ///< of the sensor; 0: the robot's first type
  std::uint32_t sensor = 0;        ///< index among the robot's sensors of that type
  std::optional<ImageKind> image;  ///< of a camera, written to `out`
  std::string out;
};

/// User settings of plots of sweeps.
struct SweepPlotOptions {
  std::string over;  ///< parameter along x; empty: the first whose numbers differ
  viz::AxisScale x_axis = viz::AxisScale::automatic;
};

struct PlotOptions : RecordingOption, PartOption, DeviceOption, PageOption, SweepPlotOptions, VideoOptions {
  std::string out;                      ///< folder; empty: the recording's
  std::string format = "png";           ///< suffix of the pictures
  bool csv = false;                     ///< also write the curves as CSV files
  std::vector<std::string> labels;      ///< robots named in the trajectories, or "all"
  std::vector<std::uint32_t> elements;  ///< of sensors, drawn as curves; empty: all
  bool curves = false;                  ///< curves instead of heat maps for readings with many elements
  bool allan = false;                   ///< only the Allan deviations of gyros and imus
};

/// Files of point clouds. `pcd`: every beam of a scan in the sensor's frame, row by ring, NaN without an echo, as
/// float32; VIEWPOINT is the sensor's pose. `ply`: the echoes in the world, in 64 bits.
enum class CloudFormat { none, pcd, ply };

struct ExportOptions : RecordingOption, PartOption, DeviceOption {
  std::string out;                         ///< folder
  bool vtk = false;                        ///< VTK files instead of CSV
  CloudFormat clouds = CloudFormat::none;  ///< files of point clouds instead of CSV
  double every = 1.0;                      ///< [s] between files of a series
  double height = 0.1;                     ///< [m] of the field's plane
};

struct ViewOptions : RecordingOption, PartOption, DeviceOption, VideoOptions {
  bridges::WebAddress port;  ///< of the page for browsers
  bool three_d = false;      ///< VTK's window instead of a browser
  double every = 0.1;        ///< [s] between frames
  double height = 0.1;       ///< [m] of the field's plane
  double time = 0.0;         ///< [s] of the first frame shown
  std::string screenshot;    ///< picture to write instead of waiting for a user; empty: none
};

struct ExplainOptions : WorldOptions, JsonOption, DeviceOption, CloneOptions, ThreadsOption {
  std::string graph;  ///< picture file of the derived sensors; empty: measure
};

/// Names of topics and frames, in recordings too.
struct NamingOption {
  record::Naming naming;
};

/// Connections to other programs (bridges). Each value is an address or a number, as described in its option's help.
struct BridgeOptions {
  std::optional<std::string> ros2;          ///< domain; empty: from the environment, or 0
  std::string player;                       ///< [HOST:]PORT of a Player server; empty: none
  std::optional<bridges::WebAddress> view;  ///< of the live view; nullopt: none
  bool any() const { return ros2 || !player.empty() || view; }
};

struct RunOptions : WorldOptions,
                    AccuracyTargetOptions,
                    JsonOption,
                    DeviceOption,
                    CloneOptions,
                    ControllerOptions,
                    NoReturnOption,
                    PortOptions,
                    ThreadsOption,
                    CompressionOption,
                    ImagesOption,
                    VideoOptions,
                    NamingOption,
                    BridgeOptions {
  bool keep_ctrl = false;          ///< `ctrl` of the world file overrides --controller
  std::vector<std::string> drive;  ///< names of the robots that the controller drives; empty: all robots
  std::optional<double> duration;  ///< [s]; nullopt: 60, or unlimited with bridges
  std::optional<double> speed;     ///< [1] simulated over real time, 0: no limit; nullopt: none, or 1 with bridges
  std::string record;              ///< folder; empty: no recording
  bool record_readings = false;
  std::string send;                        ///< host; empty: none
  bool tiles = false;                      ///< each rank owns a part of the world
  double balance = 0.0;                    ///< [s] simulated time between rebalancing of tiles; 0: never
  double checkpoint = 0.0;                 ///< [s] simulated time between checkpoints; 0: none
  bool resume = false;                     ///< restart an interrupted run and compare it with its checkpoints
  std::optional<std::string> positioning;  ///< file with keys of [positioning]; empty: the default; nullopt: no cameras
  std::string map_file;                    ///< picture of the map that the robots build; empty: none
  std::optional<bridges::WebAddress> map_view;  ///< of the page with their maps; nullopt: none
  std::string fault_file;                       ///< with [[fault]] tables; empty: none
  std::string faults;  ///< of the scenario or that file, as in the recording; not on the command line
};

struct ServeOptions : WorldOptions,
                      AccuracyTargetOptions,
                      JsonOption,
                      DeviceOption,
                      NoReturnOption,
                      PortOptions,
                      BindOption,
                      ForgetOption,
                      PeersOption,
                      FilterOptions,
                      CloneOptions,
                      DurationOption,
                      CompressionOption,
                      ImagesOption,
                      NamingOption,
                      BridgeOptions {
  std::uint32_t port = netio::kInboxPort;  ///< 0: any free port
  double rate = 0.0;                       ///< [Hz]; 0: the world's own
  double radio = netio::kV2vRange;         ///< [m] range beyond which states are not relayed; 0: no states are relayed
  std::vector<std::string> join;           ///< "NAME=FIRST-LAST": copies that may join, by id
  std::string record;                      ///< folder; empty: not recorded
  bool lockstep = false;                   ///< clients command the robots tick by tick
  double lockstep_timeout = 5.0;           ///< [s] maximum time to wait for a client; 0: unlimited
  std::uint32_t wait_for = 1;              ///< number of robots that must subscribe before the first tick
  std::uint16_t spat = 0;                  ///< port for SPaT; 0: none is received
  server::StaleLights stale_lights = server::StaleLights::dark;
  double processor_budget = 0.0;  ///< [ms] per tick; 0: no limit
  double network_budget = 0.0;    ///< [byte/s]; 0: no limit
  double own_age = 0.25;          ///< [s] of a real robot's own reading up to which it is fused
  std::string mirror;             ///< "host:port" of an observer of all readings; empty: none
};

struct RobotOptions : WorldOptions,
                      JsonOption,
                      ControllerOptions,
                      FarmOptions,
                      LinkOptions,
                      PortOptions,
                      ForgetOption,
                      PeersOption,
                      SeedOption,
                      DurationOption {
  std::string robot;               ///< name of the robot
  double rate = 0.0;               ///< [Hz]; 0: the controller's own
  double stop_after = 0.5;         ///< [s] without a reading after which the robot stops; 0: never
  bool stop_without_farm = false;  ///< also with a controller that does not need the farm's readings
  bool wait_for_start = false;
  std::uint16_t spat = 0;     ///< port for SPaT; 0: the lights come from the farm
  std::uint16_t cameras = 0;  ///< port for TAG packets; 0: none
  estimation::ClockSource camera_clock = estimation::ClockSource::estimated;
  std::uint32_t tag = 0;             ///< id of the tag that the robot carries; 0: the robot's id
  std::optional<double> most_sigma;  ///< [m] standard deviation of the estimated position at which the robot stops
  std::string truth;                 ///< "host:port" that its true state goes to; empty: none
  std::string map;                   ///< "host:port" that its own map is sent to; empty: none
  std::string map_file;              ///< picture of its own map; empty: none
  std::optional<bridges::WebAddress> view;  ///< of the page with its own map; nullopt: none
  std::string serial;                       ///< device of a real robot; empty: none
  std::string real_world;                   ///< world file of an emulated real robot; empty: none
  bool keep_readings = false;               ///< the real robot's own readings are not sent to the farm
  std::string player;                       ///< "host:port" of a Player server with a robot; empty: none
  std::string robot_type = "create";        ///< word of a server::RealRobotType
  unsigned baud = 0;                        ///< 0: the default of the type
  std::vector<std::string> v2v_peers;       ///< "host:port" of each receiver of V2V without the farm
  std::string v2v_group;                    ///< "address:port" of a multicast group for it; empty: none
  std::string v2v_interface;                ///< address of the interface for it; empty: by the route
  std::uint16_t v2v_port = 0;               ///< 0: kDirectV2vPort with `v2v_peers`, else any
  double radio = netio::kV2vRange;          ///< [m] range of V2V without the farm
};

inline constexpr std::uint16_t kDirectV2vPort = 9400;  ///< default port of V2V without the farm

inline constexpr std::uint16_t kSpatPort = 9010;  ///< default port of SPaT and MAP

struct LightOptions : OriginOption, DurationOption, PeersOption {
  std::string file;  ///< a world, or a plan that names its world
  std::string send;  ///< host; empty: none
  std::string farm;  ///< "HOST:PORT" that V2I go to; empty: none
  std::vector<std::uint16_t> ports{kSpatPort};
  double rate = 10.0;            ///< [Hz]
  double time = 0.0;             ///< [s] simulated time at the start
  std::uint32_t first_id = 1;    ///< of its intersections
  std::vector<std::string> set;  ///< "NAME=STATE", in place of a plan
};

struct StartOptions : FarmOptions, PeersOption {
  std::uint32_t start_id = netio::kBroadcastId;  ///< robot to start
};

struct ObjectOptions : FarmOptions, PeersOption {
  std::uint32_t tag = 1;  ///< id of the object's tag
  enum class State { present, absent };
  State state = State::present;
  std::string shape;                          ///< name; empty: unchanged
  std::string color;                          ///< X11 name or "#RRGGBB"; empty: unchanged
  std::optional<std::array<double, 3>> size;  ///< [m]; nullopt: unchanged
};

struct LaneOptions : FarmOptions, PeersOption {
  std::string lane;  ///< "SEGMENT.LANE"
  std::string use;   ///< a word of world::lane_use_of
};

struct ListenOptions : WorldOptions, JsonOption, CloneOptions, PortOptions, ReceiveOptions, DurationOption {};

struct DumpOptions : JsonOption, BindOption, DurationOption {
  std::string file;                  ///< capture file; empty: live
  std::vector<std::uint16_t> ports;  ///< to listen on
  std::uint64_t count = 0;           ///< stop after this many datagrams; 0: unlimited
};

struct MapOptions : ReceiveOptions, WireOption, DurationOption, PageOption {
  std::vector<std::uint16_t> map_ports;     ///< to listen on
  bool merge = false;                       ///< merge all maps into one
  std::string out;                          ///< picture; empty: none
  double interval = 1.0;                    ///< [s] between pictures of maps that change; 0: one at the end
  std::optional<bridges::WebAddress> view;  ///< of the page with the maps; nullopt: none
  bool once = false;                        ///< stop once every port has received a complete map
};

struct ExperimentOptions : SeedOption, DeviceOption, InProcessOption, CompressionOption {
  std::string experiment;  ///< name of the experiment
  bool list = false;       ///< print all names
  std::string out;         ///< folder
  std::uint32_t trials = 3;
  std::optional<scenarios::Plant> plant;  ///< nullopt: the experiment's own
  std::string experiments;                ///< folder of their files; empty: searched for
  std::string data;                       ///< folder of measurements; empty: none
};

struct TestOptions : DeviceOption, InProcessOption {
  std::vector<std::string> scenarios;  ///< files
  std::string junit;                   ///< file; empty: none
  unsigned jobs = 1;                   ///< scenarios at a time
  double timeout = 0.0;                ///< [s] wall-clock time per scenario; 0: unlimited
};

struct SweepOptions : DeviceOption, InProcessOption {
  std::string file;                 ///< sweep file
  std::string out;                  ///< folder
  unsigned jobs = 0;                ///< processes; 0: one per core, or Slurm's CPUs per task
  double timeout = 0.0;             ///< [s] wall-clock time per job; 0: unlimited
  std::string share;                ///< "K/N"; empty: all, or the task's of `srun`
  bool list = false;                ///< print the points
  bool retry = false;               ///< rerun failed jobs
  bool merge = false;               ///< write the tables of the existing results
  bool plots = true;                ///< draw the metrics
  bool slurm = false;               ///< write a batch script
  std::uint64_t tasks = 100;        ///< maximum size of the job array
  std::vector<std::string> sbatch;  ///< extra options for sbatch
};

struct VerifyOptions : RecordingOption, ThreadsOption, JsonOption, DeviceOption {
  std::uint64_t sample = 500;  ///< number of scans to recompute in plain C++; 0: all
  std::string accuracy;        ///< modes whose errors are measured at the recorded poses; empty: none
};

struct MergeOptions {
  std::vector<std::string> places;  ///< folders of ranks' recordings, or the recordings themselves
  std::string out;                  ///< folder
};

struct DeriveOptions : RecordingOption, ThreadsOption {
  std::string with;  ///< file of derived sensors
  std::string out;   ///< folder
};

struct IdentifyOptions : ThreadsOption {
  std::vector<std::string> recordings;  ///< their folders
  std::string robot;
  std::vector<std::string> inputs;  ///< TYPE or TYPE:NUMBER each
  std::string output;               ///< the same
  double rate = 10.0;               ///< [Hz]
  std::vector<double> between;      ///< least and most output; empty: any
  std::vector<std::string> where;   ///< NAME=LEAST,MOST each
  std::vector<std::string> kinds{"arx", "narx", "network"};
  std::vector<std::uint32_t> lags{1, 2, 4};
  std::vector<std::uint32_t> hidden{4, 8};
  std::uint32_t folds = 5;
  std::uint64_t seed = 1;
  bool measured = false;  ///< choose by the error of one step from measured outputs
  std::string out;        ///< file of the model
};

struct TradeoffOptions : WorldOptions,
                         AccuracyTargetOptions,
                         JsonOption,
                         DeviceOption,
                         CloneOptions,
                         ThreadsOption,
                         PageOption {
  std::string out;             ///< folder; empty: none
  std::string format = "png";  ///< suffix of the picture
};

struct VpsOptions : JsonOption, SeedOption, DurationOption, PeersOption, BindOption {
  std::string testbed;                                      ///< file
  std::vector<std::pair<std::string, std::string>> inputs;  ///< pairs of camera and source that override the file
  std::uint32_t rendered = 0;                               ///< number of tags in a simulated testbed; 0: none
  double speed = 0.5;                                       ///< [m/s] of the fastest tag
  std::uint32_t occluders = 0;                              ///< number of objects above the tags
  std::uint16_t robots = 0;                                 ///< port for robots' true states; 0: no robots are rendered
  std::uint64_t images = 0;                                 ///< per camera; 0: all
  bool real_time = false;                                   ///< at the cameras' frame rate
  std::string follow;                                       ///< ids of the tags to follow, or "off"; empty: the file's
  std::string send;                                         ///< "host:port" of tags without an address; empty: none
  std::string track;                                        ///< CSV file; empty: none
  std::string overlay;                                      ///< folder of pictures, or video; empty: none
  std::uint32_t every = 1;                                  ///< draw over every n-th image of each camera
  std::string world;                                        ///< world to draw over the pictures; empty: none
  std::uint16_t readings = 0;                               ///< port for mirrored readings; 0: none are drawn
  std::optional<bridges::WebAddress> view;                  ///< of the live view; nullopt: none
};

struct CalibrateOptions {
  std::string images;         ///< folder or video
  std::uint32_t columns = 9;  ///< inner corners of the chessboard
  std::uint32_t rows = 6;
  double square = 0.025;  ///< [m]
  std::string charuco;    ///< dictionary of the board's tags; empty: a plain chessboard
  double marker = 0.0;    ///< [m] side of the board's tags
  std::string name = "camera";
  std::string testbed;  ///< file with the camera's intrinsics and surveyed tags; empty: compute the intrinsics
};

struct SelfTestOptions : JsonOption, DeviceOption {
  std::vector<std::string> cases;  ///< or groups of cases; empty: all
  bool list = false;               ///< print all cases
};

}  // namespace sf::apps
