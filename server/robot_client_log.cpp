#include "server/robot_client_log.h"

#include <utility>

#include <fmt/format.h>

#include "base/elapsed.h"
#include "netio/signature_trouble_log.h"
#include "sensors/sensor_type.h"

namespace sf::server {

namespace {

constexpr std::int64_t kAnswerIn = 3'000'000'000;       ///< [ns] of silence before a message is logged
constexpr std::int64_t kTroubleIn = 1'000'000'000;      ///< [ns] of refused signatures before a message is logged
constexpr std::int64_t kTroubleEvery = 10'000'000'000;  ///< [ns]

/// Returns whether a line that is written at most every kTroubleEvery may be written, and notes that it is.
/// @param next [ns] time before which it may not
bool passes(std::int64_t& next, std::int64_t now) {
  if (now < next) return false;
  next = now + kTroubleEvery;
  return true;
}

}  // namespace

RobotClientLog::RobotClientLog(std::string robot, std::uint32_t id, int descriptor, std::int64_t reading_timeout)
    : robot_(std::move(robot)), id_(id), reading_timeout_(reading_timeout), log_(descriptor) {}

bool RobotClientLog::readings_timed_out(const RobotLink& link, std::int64_t now) const {
  return reading_timeout_ > 0 && link.listens() && now - link.last_reading().value_or(0) > reading_timeout_;
}

/// Logs refused signatures while nothing else arrives: immediately, then every ten seconds.
void RobotClientLog::note_signatures(const RobotLink& link, bool needs_farm, std::int64_t now) {
  const netio::SignatureTrouble& trouble = link.trouble();
  const bool is_new = trouble.count > std::exchange(troubles_, trouble.count);
  if (!is_new || now < next_trouble_ || now - link.last_answer().value_or(0) < kTroubleIn) return;
  next_trouble_ = now + kTroubleEvery;
  problem_logged_ = true;
  stands_ = reading_timeout_ > 0 && needs_farm;
  log_.write(fmt::format("the farm at {} {}", netio::endpoint_text(link.farm()),
                         netio::trouble_text(trouble, fmt::format("robot {}", id_), base::unix_time())),
             now);
}

void RobotClientLog::note_position(bool lost, bool cameras, std::int64_t now) {
  if (lost_.value_or(cameras) == lost) return void(lost_ = lost);
  lost_ = lost;
  stops_ += lost ? 1 : 0;
  const std::string unseen = fmt::format("no camera detects {} any more: it stops until one does", robot_);
  const std::string uncertain = fmt::format("the position of {} is too uncertain: it stops (--lost-beyond)", robot_);
  log_.write(!lost ? fmt::format("cameras detect {}", robot_) : cameras ? unseen : uncertain, now);
}

void RobotClientLog::note_link(const RobotLink& link, bool needs_farm, std::int64_t now) {
  const std::string farm = netio::endpoint_text(link.farm());
  const bool stops = reading_timeout_ > 0 && needs_farm;
  note_signatures(link, needs_farm, now);
  if (!problem_logged_ && link.listens() && now - link.last_answer().value_or(0) >= kAnswerIn) {
    problem_logged_ = true;
    stands_ = stops;
    log_.write(
        fmt::format("no packets from the farm at {} for 3 s; is `sensorfarm serve` running there with this world and "
                    "these ports? {}",
                    farm, stops ? "The robot stops until readings arrive" : "The robot continues"),
        now);
  }
  if (stands_ == (needs_farm && readings_timed_out(link, now)) || !link.last_reading()) return;
  stands_ = !stands_;
  stops_ += stands_ ? 1 : 0;
  log_.write(stands_ ? fmt::format("no reading from the farm at {} for {:g} s: {} stops until one arrives", farm,
                                   1e-9 * static_cast<double>(reading_timeout_), robot_)
                     : fmt::format("readings arrive: {} continues", robot_),
             now);
}

void RobotClientLog::note_ignored_drive(const std::string& controller, std::int64_t now) {
  if (!passes(next_drive_, now)) return;
  log_.write(
      fmt::format("the farm forwards commands of a Player client, which controller '{}' ignores; start the robot "
                  "with `--controller remote` to follow them",
                  controller),
      now);
}

void RobotClientLog::note_dropped(std::uint32_t sensor, const netio::Dropped& dropped, std::int64_t now) {
  auto& [last, next] = dropped_of_[{dropped.type, sensor}];
  if (dropped.processor < last.processor || dropped.network < last.network) last = {};
  dropped_.processor += dropped.processor - last.processor;
  dropped_.network += dropped.network - last.network;
  last = dropped;
  if (!passes(next, now)) return;
  const sensors::SensorType* const type = sensors::find_sensor_type(static_cast<std::uint8_t>(dropped.type));
  log_.write(
      fmt::format("the farm drops readings of {}:{}, whose priority is too low for its budget: so far {} for lack "
                  "of processor time, {} for lack of bytes",
                  type == nullptr ? fmt::format("type {}", dropped.type) : std::string(type->name), sensor,
                  dropped.processor, dropped.network),
      now);
}

void RobotClientLog::note_unshared(std::string_view type, std::size_t elements, const sensors::SensorSpec& row,
                                   std::int64_t now) {
  if (!passes(next_unshared_, now)) return;
  log_.write(
      fmt::format("the real robot's {} has {} values, and '{}' in the world file {}: its readings are not sent to "
                  "the farm; give both the same, or use `--keep-readings`",
                  type, elements, row.name, row.elements),
      now);
}

void RobotClientLog::note_unknown_lane(std::uint32_t segment, std::uint32_t lane, std::int64_t now) {
  if (!passes(next_lane_, now)) return;
  log_.write(fmt::format("the farm changes the use of lane {}.{}, which the robot's world lacks or cannot change; "
                         "expected the road network of the farm's world",
                         segment, lane),
             now);
}

void RobotClientLog::note_no_team(std::int64_t now) {
  log_.write(fmt::format("{} explores alone, because robots of a team send their maps to each other directly; give the "
                         "addresses of the others (--v2v-peers, --v2v-group)",
                         robot_),
             now);
}

void RobotClientLog::note_team(const MapExchangeCounts& counts, std::int64_t now) {
  if (counts.foreign > team_.foreign && now >= next_foreign_) {
    next_foreign_ = now + kTroubleEvery;
    log_.write(fmt::format("the maps of robots {} and {} cover different areas, so they are not shared; expected the "
                           "same `cell`, `map_left`, `map_top`, `map_width` and `map_height` for all robots of a team",
                           id_, counts.last_foreign),
               now);
  }
  if (counts.full > team_.full)
    log_.write(fmt::format("the measurements of {} of the team exceed the limit; later ones are not used",
                           counts.full == 1 ? "a robot" : "several robots"),
               now);
  if (counts.malformed > 0 && team_.malformed == 0)
    log_.write("measurements of a robot of the team are malformed and dropped; do all robots run the same version?",
               now);
  team_ = counts;
}

void RobotClientLog::note_ignored_outputs(std::string_view title, std::int64_t now) {
  if (std::exchange(outputs_ignored_, true)) return;
  log_.write(fmt::format("a {} has no digital outputs; those that the controller sets are ignored", title), now);
}

void RobotClientLog::note_real(std::string_view title, const std::string& problem, bool answered, std::int64_t now) {
  if (problem == real_problem_ || (!answered && now < kAnswerIn)) return;
  real_problem_ = problem;
  log_.write(problem.empty() ? fmt::format("the {} is ready: {} continues", title, robot_)
                             : fmt::format("{}: {} stops", problem, robot_),
             now);
}

}  // namespace sf::server
