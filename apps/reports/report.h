#pragma once
// Reports of commands, as rows of a table or as JSON. Only the source includes nlohmann/json.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/commands/rank_run.h"
#include "apps/commands/run_video.h"
#include "apps/reports/control_report.h"
#include "base/reading.h"
#include "farm/farm.h"
#include "gpu/device.h"
#include "netio/inbox.h"
#include "netio/relay.h"
#include "netio/stream_monitor.h"
#include "scenarios/explanation.h"
#include "scenarios/recorded_accuracy.h"
#include "scenarios/recording_verification.h"
#include "scenarios/tradeoff.h"
#include "selftest/case.h"
#include "sensors/sensor_set.h"
#include "server/drive_relay.h"
#include "server/light_service.h"
#include "server/lockstep.h"
#include "server/reading_fusion.h"
#include "server/reading_publisher.h"
#include "server/state_filter.h"
#include "world/world.h"

namespace sf::apps {

/// Results of a run or a service.
struct RunReport {
  std::string device;
  bool software = false;
  std::string caster;  ///< description of the ray caster
  std::uint32_t robots = 0;
  std::uint64_t ticks = 0;
  double simulated_s = 0.0;
  double wall_s = 0.0;
  std::uint64_t contacts = 0;  ///< number of robot contacts that began
  /// Robots that have left the known space of the world's ROS map; nullopt: the world has no ROS map.
  std::optional<std::vector<std::string>> strayed;
  ControlReport control;  ///< no robots: other processes control them
  double move_s = 0.0;    ///< [s] spent on controllers and motion
  double out_s = 0.0;     ///< [s] spent on packets and recording
  farm::FarmStats farm;
  std::uint64_t hash = 0;
  bool interrupted = false;
  bool sent = false;  ///< `publisher` is valid
  server::PublisherCounts publisher;
  bool received = false;  ///< `inbox` is valid
  netio::PacketCounts inbox;
  std::uint64_t socket_drops = 0;  ///< datagrams dropped because the inbox's buffer was full
  netio::RelayCounts relayed;      ///< states of other robots and start signals, relayed to robots
  server::DriveCounts drives;      ///< commands of users of bridges, relayed to robots
  server::FusionCounts fusion;     ///< of readings of real robots' own sensors
  server::LightServiceCounts lights;
  bool filtered = false;  ///< `states` and `clocks` are valid
  server::StateFilterCounts states;
  struct Clock {
    std::string name;  ///< of the mover
    estimation::ClockState clock;
  };
  std::vector<Clock> clocks;                       ///< of the senders of states
  std::uint64_t lines_left_out = 0;                ///< of the log
  std::string recording;                           ///< file; empty: none
  std::uint64_t recorded_bytes = 0;                ///< its size
  VideoFacts video;                                ///< no file name: no video
  std::string recording_error;                     ///< why it ends before the run; empty: it is complete
  std::optional<server::LockstepCounts> lockstep;  ///< for a service in lockstep
  std::optional<RankReport> shared;                ///< fleet shared by ranks; times are means over them, counts sums
};

/// Results of `selftest`.
struct SelfTestReport {
  gpu::DeviceInfo device;
  std::vector<std::pair<const selftest::Case*, selftest::Outcome>> cases;  ///< that were run
  std::size_t asked = 0;  ///< number of cases selected; more than were run if interrupted
  double seconds = 0.0;   ///< [s] of all cases

  std::size_t passed() const;
  bool interrupted() const { return cases.size() < asked; }
  /// True if all cases were run, at least one, and all passed.
  bool sound() const { return !cases.empty() && passed() == cases.size() && !interrupted(); }
};

/// Prints the number of warnings and the first three of them on standard error. @param file for which `check` lists all
/// warnings
void print_warnings(const std::string& file, const std::vector<world::Warning>& warnings);
/// Prints the first three of these lines about derived sensors (sensors::DerivedSensors::never_valid), and the number
/// of the others, on standard error.
void print_never_valid(std::span<const std::string> lines);
/// Returns one line "file:line: warning: message" per warning.
std::string warnings_text(std::span<const world::Warning> warnings);
/// Appends the list of all warnings to the JSON object.
std::string with_warnings(std::string json, const std::vector<world::Warning>& warnings);

/// Prints on standard error which data a recording lacks.
void print_damage(const record::Recording& recording);

std::size_t count_robots(const world::World& world);
/// Throws an error that lists the names of the world's robots. @param names that may be suggested for `name`
[[noreturn]] void refuse_robot(const world::World& world, const std::string& name,
                               const std::vector<std::string_view>& names);
/// Counts fixed and carried magnets.
std::size_t count_magnets(const world::World& world);
std::size_t triangles_of(std::span<const world::Mesh> meshes);
/// Counts the docks among the infrared emitters; the others are virtual walls.
std::size_t count_docks(const world::World& world);

std::string device_list_json(const gpu::DeviceList& list);
std::string world_report_json(const world::World& world, const sensors::SensorSet& sensor_set);
std::string run_report_json(const RunReport& facts);
std::string stream_summary_json(const netio::StreamSummary& summary);
/// Returns one reading. Infinite and missing values are null.
std::string reading_json(const world::World& world, const sensors::SensorSet& sensor_set,
                         const base::ReadingBlock& reading);

/// Returns the name of the model that a beam hits, "floor", or "" for no hit. @param hit as base::ReadingBlock::hits
std::string hit_name(const world::World& world, std::uint32_t hit);

std::string device_list_text(const gpu::DeviceList& list);
std::string world_report_text(const world::World& world, const sensors::SensorSet& sensor_set);
std::string run_report_text(const RunReport& facts);
/// Returns a text such as "5 lasers exact, within 1.03 nm: beams that graze nothing".
std::string accuracy_statement_text(const sensors::AccuracyStatement& statement);
std::string stream_summary_text(const netio::StreamSummary& summary);
/// Returns comma-separated values: a heading, then one line per element. Fields of missing values are empty.
std::string reading_csv(const world::World& world, const sensors::SensorSet& sensor_set,
                        const base::ReadingBlock& reading);
/// @param recorded true if the run recorded its readings
std::string verification_text(const scenarios::Verification& verification, bool recorded);
/// @param accuracy null if not requested
std::string verification_json(const scenarios::Verification& verification,
                              const scenarios::RecordedAccuracy* accuracy = nullptr);
std::string recorded_accuracy_text(const scenarios::RecordedAccuracy& accuracy);
std::string explanation_text(const scenarios::Explanation& explanation);
std::string explanation_json(const scenarios::Explanation& explanation);
std::string mode_results_text(const std::vector<scenarios::ModeResult>& results);
std::string mode_results_json(const std::vector<scenarios::ModeResult>& results,
                              const scenarios::AccuracyTarget& target);
std::string self_test_text(const SelfTestReport& test);
std::string self_test_json(const SelfTestReport& test);
/// Poses of robot and sensor, in one line: six numbers each if the robot is tilted or not at a height of 0.
std::string place_of(const world::World& world, const sensors::SensorSet& sensor_set,
                     const base::ReadingBlock& reading);

}  // namespace sf::apps
