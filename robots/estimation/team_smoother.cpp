#include "robots/estimation/team_smoother.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace sf::estimation {

namespace {

constexpr std::int64_t kMostApart = 200'000'000;  // [ns] between two nodes

/// A time at which all robots have one common state, with the events at that time.
struct Node {
  std::int64_t time = 0;
  std::size_t first = 0, last = 0;  ///< [first, last) of the events
};

using RobotBlock = Eigen::Map<const Eigen::Matrix<double, kTeamComponents, kTeamComponents>>;

/// Mean and covariance from all readings.
struct Smoothed {
  std::vector<double> mean, covariance;
};

Eigen::Map<const Eigen::VectorXd> vector_of(const std::vector<double>& all) {
  return {all.data(), static_cast<Eigen::Index>(all.size())};
}
Eigen::Map<const Eigen::MatrixXd> matrix_of(const std::vector<double>& all, Eigen::Index size) {
  return {all.data(), size, size};
}

std::vector<TeamEvent> sorted_events(const Team& team, std::vector<TeamEvent> events) {
  std::sort(events.begin(), events.end());
  std::vector<bool> started(team.robots, false);
  std::erase_if(events, [&](const TeamEvent& each) {
    if (each.kind != TeamEvent::Kind::pose) return false;
    const bool again = started[each.robot];
    started[each.robot] = true;
    return again;
  });
  return events;
}

std::vector<Node> nodes_of(const std::vector<TeamEvent>& events) {
  std::vector<Node> nodes;
  for (std::size_t k = 0; k < events.size(); ++k) {
    const std::int64_t time = events[k].time;
    while (!nodes.empty() && time - nodes.back().time > kMostApart)
      nodes.push_back({nodes.back().time + kMostApart, k, k});
    if (nodes.empty() || nodes.back().time < time) nodes.push_back({time, k, k});
    nodes.back().last = k + 1;
  }
  return nodes;
}

class Smoother {
 public:
  Smoother(const Team& team, TeamReadings readings, std::span<const std::vector<std::int64_t>> times)
      : team_(team), speeds_(std::move(readings.speeds)), times_(times), results_(team.robots) {
    for (std::vector<Speeds>& each : speeds_) std::sort(each.begin(), each.end());
    events_ = sorted_events(team, std::move(readings.events));
    nodes_ = nodes_of(events_);
    for (const auto& each : times) left_.push_back(each.size());
  }

  std::vector<std::vector<Estimate>> run(const std::function<bool()>& stop) {
    if (nodes_.empty()) return std::move(results_);
    // Forwards, keeping the states at the ends of segments.
    const auto segment = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(nodes_.size()))));
    std::vector<TeamState> kept;
    TeamState state = first_state(team_);
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      if (k % segment == 0) kept.push_back(state);
      if (k % 64 == 0 && stop && stop()) return std::move(results_);
      step(nodes_[k], state);
    }
    // Backwards, one segment after another; `kept` is the state before its first node.
    Smoothed later{state.mean, state.covariance};
    for (std::size_t s = kept.size(); s-- > 0;) {
      std::vector<TeamState> states{std::move(kept[s])};
      const std::size_t first = s * segment, last = std::min(first + segment, nodes_.size());
      for (std::size_t k = first; k < last; ++k) {
        states.push_back(states.back());
        step(nodes_[k], states.back());
      }
      for (std::size_t k = last; k-- > first;) {
        if (k % 64 == 0 && stop && stop()) return std::move(results_);
        TeamState& here = states[k + 1 - first];
        if (k + 1 < nodes_.size()) later = smoothed(here, nodes_[k].time, nodes_[k + 1].time, later);
        TeamState refined = here;
        refined.mean = later.mean;
        refined.covariance = later.covariance;
        emit(refined, nodes_[k].time);
      }
    }
    for (auto& each : results_) std::reverse(each.begin(), each.end());
    return std::move(results_);
  }

 private:
  void step(const Node& node, TeamState& state) const {
    for (std::uint32_t r = 0; r < team_.robots; ++r) advance(team_, r, node.time, speeds_[r], state);
    for (std::size_t k = node.first; k < node.last; ++k) apply(team_, events_[k], speeds_, state);
  }

  /// Returns the smoothed state at a node, given that of the next one.
  Smoothed smoothed(const TeamState& here, std::int64_t time, std::int64_t next, const Smoothed& later) const {
    const auto size = static_cast<Eigen::Index>(here.mean.size());
    const auto covariance = matrix_of(here.covariance, size), later_covariance = matrix_of(later.covariance, size);
    Eigen::VectorXd mean = vector_of(here.mean);
    Eigen::MatrixXd C = covariance, P = covariance;  // C: covariance of here and next
    for (std::uint32_t r = 0; r < team_.robots; ++r) {
      const Eigen::Index at = kTeamComponents * static_cast<Eigen::Index>(r);
      if (here.robots[r].time < 0) {  // starts later: keep its later mean
        P.block<kTeamComponents, kTeamComponents>(at, at).setIdentity();
        mean.segment<kTeamComponents>(at) = vector_of(later.mean).segment<kTeamComponents>(at);
        continue;
      }
      TeamMotion moved = TeamMotion::from(here, r);
      drive(team_.model, time, next, speeds_[r], moved);
      const RobotBlock F(moved.derivative.data()), Q(moved.noise.data());
      std::copy(moved.mean.begin(), moved.mean.end(), mean.begin() + at);
      C.middleCols<kTeamComponents>(at) = C.middleCols<kTeamComponents>(at).eval() * F.transpose();
      P.middleRows<kTeamComponents>(at) = F * P.middleRows<kTeamComponents>(at).eval();
      P.middleCols<kTeamComponents>(at) = P.middleCols<kTeamComponents>(at).eval() * F.transpose();
      P.block<kTeamComponents, kTeamComponents>(at, at) += Q;
    }
    const Eigen::MatrixXd G = P.ldlt().solve(C.transpose()).transpose();
    const Eigen::VectorXd refined = vector_of(here.mean) + G * (vector_of(later.mean) - mean);
    const Eigen::MatrixXd rest = covariance + G * (later_covariance - P) * G.transpose();
    Smoothed result{{refined.begin(), refined.end()}, std::vector<double>(here.covariance.size())};
    Eigen::Map<Eigen::MatrixXd>(result.covariance.data(), size, size) = 0.5 * (rest + rest.transpose());
    return result;
  }

  /// Adds the estimates at and after a node that have not been added yet.
  void emit(const TeamState& state, std::int64_t time) {
    for (std::uint32_t r = 0; r < team_.robots; ++r) {
      for (; left_[r] > 0 && times_[r][left_[r] - 1] >= time; --left_[r]) {
        if (state.robots[r].time < 0) continue;
        TeamMotion moved = TeamMotion::from(state, r);
        drive(team_.model, time, times_[r][left_[r] - 1], speeds_[r], moved);
        results_[r].push_back(estimate_after(team_, state, r, moved, times_[r][left_[r] - 1]));
      }
    }
  }

  const Team& team_;
  std::vector<TeamEvent> events_;
  std::vector<std::vector<Speeds>> speeds_;
  std::span<const std::vector<std::int64_t>> times_;
  std::vector<Node> nodes_;
  std::vector<std::size_t> left_;  ///< by robot: number of times without an estimate, from the first
  std::vector<std::vector<Estimate>> results_;
};

}  // namespace

std::vector<std::vector<Estimate>> smooth(const Team& team, TeamReadings readings,
                                          std::span<const std::vector<std::int64_t>> times,
                                          const std::function<bool()>& stop) {
  return Smoother(team, std::move(readings), times).run(stop);
}

}  // namespace sf::estimation
