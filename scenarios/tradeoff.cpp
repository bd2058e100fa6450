#include "scenarios/tradeoff.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "base/elapsed.h"
#include "base/tilted_pose.h"
#include "base/time.h"
#include "farm/farm.h"
#include "scenarios/error_distribution.h"
#include "scenarios/recorded_paths.h"
#include "sensors/accuracy.h"
#include "sensors/laser.h"
#include "sensors/laser_reference.h"

namespace sf::scenarios {

namespace {

constexpr double kTradeoffDriven = 2.0;         // [s] simulated
constexpr std::size_t kMostValues = 4'000'000;  // elements of one mode whose errors are evaluated
constexpr int kRounds = 5;                      // timed laps; modes alternate
constexpr std::size_t kReferenceScans = 64;

/// Readings of one mode along the paths, first columns only.
struct Read {
  std::vector<double> values;
  std::vector<double> bounds;  ///< bounds that cover them; infinite: none
};

/// A farm with one subscribed sensor type in one mode.
class ModeEntrant {
 public:
  ModeEntrant(const world::World& world, gpu::Device& device, const sensors::SensorType& type, std::uint8_t mode,
              const RecordedPaths& paths, const TradeoffOptions& options)
      : type_(type), mode_(mode), world_(world), paths_(paths) {
    sensors::set_accuracy(world_, std::string(sensors::word_of(type, mode)));
    farm_ = std::make_unique<farm::Farm>(
        world_, device,
        farm::FarmOptions{.seed = options.seed, .noise = false, .reuse_unchanged = false, .threads = options.threads});
    for (std::uint32_t m = 0; m < world_.movers.size(); ++m) farm_->subscribe(m, base::only(type.id));
  }

  /// First lap: collects the readings and warms up.
  Read read() {
    Read read;
    lap([&](const base::ReadingBlock& block) { take(block, read); });
    return read;
  }
  /// One timed lap.
  void time() {
    std::size_t elements = 0;
    const auto start = std::chrono::steady_clock::now();
    lap([&](const base::ReadingBlock& block) { elements += block.values.size() / width_of(block); });
    laps_.push_back(base::seconds_since(start));
    elements_ = elements;
  }
  double tick() const { return median_lap() / static_cast<double>(paths_.size()); }
  double rate() const { return static_cast<double>(elements_) / median_lap(); }
  std::uint8_t mode() const { return mode_; }
  const world::World& world() const { return world_; }

 private:
  std::size_t width_of(const base::ReadingBlock& block) const {
    return sensors::element_width(type_, farm_->sensor_set().row(block));
  }

  template <class Look>
  void lap(Look look) {
    const std::int64_t interval = base::nanoseconds(world_.interval);
    for (const auto& reports : paths_) {
      for (const base::ReadingBlock& block : farm_->tick(now_, reports)) look(block);
      now_ += interval;
    }
  }

  void take(const base::ReadingBlock& block, Read& read) {
    if (read.values.size() > kMostValues) return;
    const std::size_t width = width_of(block);
    for (std::size_t i = 0; i < block.values.size(); i += width) {
      read.values.push_back(block.values[i]);
      read.bounds.push_back(covering_bound(block, i / width, block.values[i]));
    }
  }

  double median_lap() const {
    std::vector<double> sorted = laps_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }

  const sensors::SensorType& type_;
  std::uint8_t mode_;
  world::World world_;
  const RecordedPaths& paths_;
  std::unique_ptr<farm::Farm> farm_;
  std::int64_t now_ = 0;
  std::vector<double> laps_;  ///< [s]
  std::size_t elements_ = 0;  ///< per lap
};

/// [m] Errors of a sample of scans in mode `exact` against the plain C++ reference, which is independent of the device.
ErrorDistribution laser_errors(const ModeEntrant& exact, const RecordedPaths& paths, const Read& read,
                               const sensors::SensorSet& sensor_set) {
  ErrorDistribution errors;
  sensors::LaserReference reference(exact.world(), 0, false);
  const auto& rows = sensor_set.group(sensors::kLaser)->rows;
  // Scans of the first tick: every laser has its first reading there unless it has a phase.
  std::vector<base::Pose> poses;
  for (const base::Report& report : paths.front()) poses.push_back(report.X_WM);
  reference.set_poses(poses);
  std::size_t at = 0;
  for (std::size_t i = 0; i < std::min(rows.size(), kReferenceScans); ++i) {
    if (rows[i].phase > 0.0 || rows[i].latency > 0.0) return {};
    const auto scan = reference.scan(rows[i].mover, rows[i].sensor, 0);
    for (const double range : scan.ranges) errors.add(read.values[at++], range, HUGE_VAL);
  }
  return errors;
}

void grade_errors(const ErrorDistribution& errors, ModeResult& grade) {
  grade.median = errors.quantile(0.5);
  grade.p99 = errors.quantile(0.99);
  grade.max = errors.max();
}

void compare(const Read& read, const Read& exact, ModeResult& grade) {
  ErrorDistribution errors;
  for (std::size_t i = 0; i < std::min(read.values.size(), exact.values.size()); ++i)
    errors.add(read.values[i], exact.values[i], read.bounds[i]);
  grade.bound = errors.bound();
  grade.covered = errors.covered();
  grade.covered_max = errors.covered_max();
  grade_errors(errors, grade);
}

void find_front(std::vector<ModeResult>& results, std::size_t first) {
  for (std::size_t i = first; i < results.size(); ++i) {
    const auto better = [&](const ModeResult& other) {
      return !is_pointless(other, results[first]) && other.rate >= results[i].rate && other.p99 <= results[i].p99 &&
             (other.rate > results[i].rate || other.p99 < results[i].p99);
    };
    results[i].front = !is_pointless(results[i], results[first]) &&
                       std::none_of(results.begin() + static_cast<std::ptrdiff_t>(first), results.end(), better);
  }
}

}  // namespace

std::vector<ModeResult> tradeoff(const world::World& world, gpu::Device& device, const TradeoffOptions& options) {
  const sensors::SensorSet sensor_set(world);
  const RecordedPaths paths = record_paths(world, device, kTradeoffDriven, options.seed, options.threads);
  double all = 0.0, done = 0.0;
  for (const auto& group : sensor_set.groups()) all += static_cast<double>(group.type->modes.size() * (1 + kRounds));
  const auto go_on = [&] { return !options.progress || options.progress(++done / all); };

  std::vector<ModeResult> results;
  for (const auto& group : sensor_set.groups()) {
    const sensors::SensorType& type = *group.type;
    if (type.modes.empty()) continue;
    std::vector<std::unique_ptr<ModeEntrant>> entrants;
    const std::size_t first = results.size();
    Read exact;
    for (std::uint8_t mode = 0; mode < type.modes.size(); ++mode) {
      entrants.push_back(std::make_unique<ModeEntrant>(world, device, type, mode, paths, options));
      const Read read = entrants.back()->read();
      ModeResult grade{.sensor = std::string(type.name),
                       .mode = std::string(type.modes[mode].word),
                       .what = std::string(type.modes[mode].what),
                       .unit = std::string(sensors::unit_of(type))};
      if (mode == 0) exact = read;
      compare(read, exact, grade);
      const auto level = [](const base::Report& report) { return base::is_level(report.tilt); };
      const auto planar = [](const sensors::CastLaser& cast) { return base::is_level(cast.laser.tilt); };
      if (mode == 0 && type.id == sensors::kLaser && world.terrain.empty() &&
          std::ranges::all_of(paths.front(), level) &&
          std::ranges::all_of(sensor_set.settings_of<sensors::CastLaser>(sensors::kLaser), planar)) {
        grade_errors(laser_errors(*entrants[0], paths, read, sensor_set), grade);
        grade.covered_max = grade.max;  // `exact` does not differ from itself
      }
      results.push_back(grade);
      if (!go_on()) return {};
    }
    for (int round = 0; round < kRounds; ++round)
      for (auto& entrant : entrants) {
        entrant->time();
        if (!go_on()) return {};
      }
    for (std::size_t i = 0; i < entrants.size(); ++i) {
      results[first + i].rate = entrants[i]->rate();
      results[first + i].tick = entrants[i]->tick();
    }
    find_front(results, first);
  }
  return results;
}

std::string csv_of(const std::vector<ModeResult>& results) {
  std::string text =
      "sensor,mode,rate_per_s,covered,covered_max_error,covered_bound,all_median_error,all_p99_error,all_max_error\n";
  for (const ModeResult& g : results) {
    const std::string covered = g.covered > 0.0 ? fmt::format("{:.6g},{}", g.covered_max, g.bound) : ",";
    text += fmt::format("{},{},{:.6g},{:.6g},{},{:.6g},{:.6g},{:.6g}\n", g.sensor, g.mode, g.rate, g.covered, covered,
                        g.median, g.p99, g.max);
  }
  return text;
}

}  // namespace sf::scenarios
