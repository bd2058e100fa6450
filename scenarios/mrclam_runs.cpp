#include "scenarios/mrclam_runs.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <tuple>
#include <utility>

#include "base/thread_pool.h"
#include "robots/estimation/team_smoother.h"

namespace sf::scenarios {

namespace {

using estimation::Estimate;
using record::MrclamData;
using record::MrclamRobot;

constexpr estimation::PoseCovariance kStartCovariance{1e-4, 0.0, 0.0, 1e-4, 0.0, 1e-4};  // of the truth's poses
constexpr std::int64_t kKeptApart = 1'000'000'000;                                       // [ns]

/// One run of the filter and the smoother: all robots of a team, or one robot alone.
struct Job {
  MrclamLandmarks landmarks = MrclamLandmarks::all;
  bool cooperative = false;
  std::vector<std::size_t> robots;  ///< of the data
};

std::vector<Job> all_jobs(const MrclamData& data) {
  std::vector<Job> jobs;
  // The longest first, so that no thread is left with it.
  for (const auto landmarks : {MrclamLandmarks::none, MrclamLandmarks::all, MrclamLandmarks::third}) {
    Job team{landmarks, true, {}};
    for (std::size_t k = 0; k < data.robots.size(); ++k) team.robots.push_back(k);
    jobs.push_back(team);
  }
  for (const auto landmarks : {MrclamLandmarks::all, MrclamLandmarks::third, MrclamLandmarks::none})
    for (std::size_t k = 0; k < data.robots.size(); ++k) jobs.push_back({landmarks, false, {k}});
  return jobs;
}

/// A reading, in the order of arrival.
struct Input {
  std::int64_t time = 0;  ///< [ns]
  bool sighting = false;
  std::uint32_t robot = 0;
  std::size_t row = 0;  ///< of the robot's odometry or sightings

  auto key() const { return std::tuple(time, !sighting, robot, row); }
};

class Run {
 public:
  Run(const MrclamData& data, const estimation::TeamModel& model, const Job& job) : data_(data), job_(job) {
    team_.model = model;
    team_.robots = static_cast<std::uint32_t>(job.robots.size());
    for (std::size_t k = 0; k < data.landmarks.size(); ++k) {
      if (job.landmarks == MrclamLandmarks::third && k % 3 != 0) continue;
      subjects_.push_back(data.landmarks[k].subject);
      team_.landmarks.push_back(job.landmarks == MrclamLandmarks::none ? std::nullopt
                                                                       : std::optional(data.landmarks[k].p));
    }
    times_.resize(team_.robots);
    for (std::uint32_t r = 0; r < team_.robots; ++r)
      for (const auto& each : robot(r).odometry)
        if (true_pose(robot(r).truth, each.time)) times_[r].push_back(each.time);
  }

  const std::vector<std::vector<std::int64_t>>& times() const { return times_; }

  /// Causal: each estimate uses the readings up to its time.
  std::vector<std::vector<Estimate>> filter(const std::function<bool()>& stop) const {
    estimation::TeamLocalization filter(team_);
    std::vector<std::vector<Estimate>> all(team_.robots);
    std::size_t count = 0;
    for (const Input& input : inputs()) {
      if (++count % 256 == 0 && stop && stop()) throw base::Interrupted();
      if (input.sighting) {
        const auto& seen = robot(input.robot).sightings[input.row];
        filter.add_sighting(input.robot, seen.time, *target_of(seen.subject), seen.range, seen.bearing);
        continue;
      }
      const auto& odometry = robot(input.robot).odometry[input.row];
      const bool counts = std::binary_search(times_[input.robot].begin(), times_[input.robot].end(), odometry.time);
      if (counts && all[input.robot].empty())
        filter.add_pose(input.robot, odometry.time, *start_of(input.robot), kStartCovariance);
      filter.add_odometry(input.robot, odometry.time, odometry.forward, odometry.turn);
      if (counts) all[input.robot].push_back(filter.predict(input.robot, odometry.time).estimate);
    }
    return all;
  }

  std::vector<std::vector<Estimate>> smoother(const std::function<bool()>& stop) const {
    estimation::TeamReadings readings;
    readings.speeds.resize(team_.robots);
    for (std::uint32_t r = 0; r < team_.robots; ++r) {
      if (const auto start = start_of(r))
        readings.events.push_back(estimation::start_event(r, times_[r].front(), *start, kStartCovariance));
      for (const auto& each : robot(r).odometry)
        readings.speeds[r].push_back(estimation::effective_speeds(team_.model, each.time, each.forward, each.turn));
      for (const auto& each : robot(r).sightings)
        if (const auto target = target_of(each.subject))
          readings.events.push_back(
              estimation::sighting_event(team_.model, r, each.time, *target, each.range, each.bearing));
    }
    auto all = estimation::smooth(team_, std::move(readings), times_, stop);
    if (stop && stop()) throw base::Interrupted();
    return all;
  }

  const MrclamRobot& robot(std::uint32_t r) const { return data_.robots[job_.robots[r]]; }

 private:
  std::optional<base::Pose> start_of(std::uint32_t r) const {
    return times_[r].empty() ? std::nullopt : true_pose(robot(r).truth, times_[r].front());
  }

  /// Returns nullopt for subjects that this run does not use.
  std::optional<std::uint32_t> target_of(int subject) const {
    for (std::uint32_t r = 0; r < team_.robots; ++r)
      if (job_.cooperative && robot(r).subject == subject) return r;
    const auto found = std::lower_bound(subjects_.begin(), subjects_.end(), subject);
    if (found == subjects_.end() || *found != subject) return std::nullopt;
    return team_.robots + static_cast<std::uint32_t>(found - subjects_.begin());
  }

  std::vector<Input> inputs() const {
    std::vector<Input> all;
    for (std::uint32_t r = 0; r < team_.robots; ++r) {
      for (std::size_t k = 0; k < robot(r).odometry.size(); ++k)
        all.push_back({robot(r).odometry[k].time, false, r, k});
      for (std::size_t k = 0; k < robot(r).sightings.size(); ++k)
        if (target_of(robot(r).sightings[k].subject)) all.push_back({robot(r).sightings[k].time, true, r, k});
    }
    std::sort(all.begin(), all.end(), [](const Input& a, const Input& b) { return a.key() < b.key(); });
    return all;
  }

  const MrclamData& data_;
  const Job& job_;
  estimation::Team team_;
  std::vector<int> subjects_;                     ///< of the team's landmarks, sorted
  std::vector<std::vector<std::int64_t>> times_;  ///< [ns] by robot: odometry within the truth
};

/// Returns e^T P^-1 e / 3, by Cholesky's method.
double nees_of(const std::array<double, 3>& e, const estimation::Covariance& P) {
  std::array<std::array<double, 3>, 3> L{};
  std::array<double, 3> z{};
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    double rest = e[i];
    for (std::size_t j = 0; j <= i; ++j) {
      double v = P[i * estimation::kComponents + j];
      for (std::size_t k = 0; k < j; ++k) v -= L[i][k] * L[j][k];
      L[i][j] = i == j ? std::sqrt(v) : v / L[j][j];
      if (j < i) rest -= L[i][j] * z[j];
    }
    z[i] = rest / L[i][i];
    sum += z[i] * z[i];
  }
  return sum / 3.0;
}

MrclamRow score(const MrclamRobot& robot, const std::vector<Estimate>& estimates, std::int64_t first) {
  MrclamRow row{.robot = robot.subject};
  std::int64_t next = 0;
  for (const Estimate& each : estimates) {
    const base::Pose truth = *true_pose(robot.truth, each.time);
    const std::array<double, 3> e{each.X_WM.x - truth.x, each.X_WM.y - truth.y,
                                  base::wrap_angle(each.X_WM.yaw - truth.yaw)};
    const double nees = nees_of(e, each.covariance);
    row.rms_m += e[0] * e[0] + e[1] * e[1];
    row.rms_deg += e[2] * e[2];
    row.nees += nees;
    ++row.samples;
    if (each.time < next) continue;
    next = each.time + kKeptApart;
    row.kept.push_back({1e-9 * static_cast<double>(each.time - first), truth, each, nees});
  }
  const auto count = static_cast<double>(std::max<std::size_t>(row.samples, 1));
  row.rms_m = std::sqrt(row.rms_m / count);
  row.rms_deg = std::sqrt(row.rms_deg / count) * 180.0 / M_PI;
  row.nees /= count;
  return row;
}

std::int64_t first_time(const MrclamData& data) {
  std::int64_t first = INT64_MAX;
  for (const MrclamRobot& robot : data.robots)
    for (const auto& each : robot.odometry)
      if (true_pose(robot.truth, each.time)) {
        first = std::min(first, each.time);
        break;
      }
  return first;
}

}  // namespace

std::optional<base::Pose> true_pose(const std::vector<record::MrclamTruth>& truth, std::int64_t time) {
  const auto after = std::lower_bound(truth.begin(), truth.end(), time,
                                      [](const record::MrclamTruth& each, std::int64_t t) { return each.time < t; });
  if (after == truth.end()) return std::nullopt;
  if (after->time == time) return after->X_WM;
  if (after == truth.begin()) return std::nullopt;
  const base::Pose &a = (after - 1)->X_WM, &b = after->X_WM;
  const double share =
      static_cast<double>(time - (after - 1)->time) / static_cast<double>(after->time - (after - 1)->time);
  return base::Pose{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), 0.0,
                    base::wrap_angle(a.yaw + share * base::wrap_angle(b.yaw - a.yaw))};
}

std::vector<MrclamRow> run_mrclam(const record::MrclamData& data, const estimation::TeamModel& model, unsigned threads,
                                  const std::function<bool()>& stop, const std::function<void(double)>& progress) {
  const std::vector<Job> jobs = all_jobs(data);
  const std::int64_t first = first_time(data);
  std::vector<MrclamRow> rows;
  std::mutex mutex;
  std::size_t done = 0;
  base::ThreadPool pool(threads);
  pool.parallel_for_each(jobs.size(), 1, [&](std::size_t k, unsigned) {
    const Run run(data, model, jobs[k]);
    for (const bool smoother : {false, true}) {
      const auto estimates = smoother ? run.smoother(stop) : run.filter(stop);
      const std::lock_guard lock(mutex);
      for (std::uint32_t r = 0; r < estimates.size(); ++r) {
        rows.push_back(score(run.robot(r), estimates[r], first));
        rows.back().landmarks = jobs[k].landmarks;
        rows.back().cooperative = jobs[k].cooperative;
        rows.back().smoother = smoother;
      }
      if (progress) progress(0.5 * static_cast<double>(++done) / static_cast<double>(jobs.size()));
    }
  });
  const auto key = [](const MrclamRow& r) { return std::tuple(r.landmarks, r.cooperative, r.smoother, r.robot); };
  std::sort(rows.begin(), rows.end(), [&](const MrclamRow& a, const MrclamRow& b) { return key(a) < key(b); });
  return rows;
}

}  // namespace sf::scenarios
