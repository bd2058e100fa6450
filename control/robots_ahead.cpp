#include "control/robots_ahead.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/elementary.h"

namespace sf::control {

OnRoute on_route(const LaneCorridors& corridors, const RoutePlan& plan, double s, std::size_t from_leg) {
  std::size_t i = from_leg;
  while (i + 1 < plan.legs.size() && s >= end_of(plan.legs[i])) ++i;
  const RouteLeg& leg = plan.legs[i];
  const Way& way = corridors.way(leg.way);
  const double at = std::clamp(leg.from + s - leg.start, leg.from, leg.to);
  return {i, point_on(way, at), yaw_on(way, at), curvature_on(way, at), height_on(way, at)};
}

bool cusp_after(const LaneCorridors& corridors, const RoutePlan& plan, std::size_t leg) {
  if (leg + 1 >= plan.legs.size()) return true;
  const Way& a = corridors.way(plan.legs[leg].way);
  const Way& b = corridors.way(plan.legs[leg + 1].way);
  if (a.kind != Way::Kind::zone && b.kind != Way::Kind::zone) return false;
  const double turn = yaw_on(b, plan.legs[leg + 1].from) - yaw_on(a, plan.legs[leg].to);
  return a.backwards != b.backwards || std::abs(base::wrap_angle(turn)) > 0.3;
}

void find_robots_ahead(const LaneCorridors& corridors, const RoutePlan& plan, double s,
                       const std::vector<RoadUser>& road_users, std::vector<LeadRobot>& out) {
  out.clear();
  if (road_users.size() < 2) return;
  const double radius = corridors.body().radius;
  const double step = 0.25 * radius;
  struct Point {
    glm::dvec2 p;
    double yaw, s, within, z;
  };
  std::array<Point, 128> points;
  std::size_t count = 0;
  std::size_t leg = leg_at(plan, s);
  const double end = std::min(s + kLookaheadDistance, length_of(plan));
  for (double at = s; count < points.size(); at += step) {
    const OnRoute here = on_route(corridors, plan, std::min(at, end), leg);
    leg = here.leg;
    const bool zone = corridors.way(plan.legs[leg].way).kind == Way::Kind::zone;
    points[count++] = {here.p, here.yaw, std::min(at, end), radius * (zone ? 2.04 : 2.18), here.z};
    if (at >= end) break;
  }
  const glm::dvec2 self{road_users[0].X_WM.x, road_users[0].X_WM.y};
  for (std::uint32_t row = 1; row < road_users.size(); ++row) {
    const glm::dvec2 p{road_users[row].X_WM.x, road_users[row].X_WM.y};
    if (length(p - self) > kLookaheadDistance + 2.2 * radius) continue;
    const auto away = [&](std::size_t i) { return length(points[i].p - p); };
    for (std::size_t i = 0; i < count;) {
      // Neighbouring points are at most one step apart, which bounds the decrease of the distance per point.
      const double distance = away(i);
      if (corridors.apart(points[i].z, road_users[row].X_WM.z)) {
        ++i;
        continue;
      }
      if (distance >= points[i].within) {
        i += std::max<std::size_t>(1, static_cast<std::size_t>((distance - points[i].within) / step));
        continue;
      }
      if (i == 0 && (count < 2 || away(1) >= distance)) break;
      double free = points[i].s - s;
      if (i > 0) {
        const double before = away(i - 1);
        const double nearer = std::max(before - distance, 1e-9);
        free -= (points[i].s - points[i - 1].s) * std::clamp((points[i].within - distance) / nearer, 0.0, 1.0);
      }
      const glm::dvec2 along = base::direction(points[i].yaw);
      out.push_back({std::max(free, 0.0), dot(road_users[row].velocity, along), row});
      break;
    }
  }
  std::sort(out.begin(), out.end(),
            [](const LeadRobot& a, const LeadRobot& b) { return a.free != b.free ? a.free < b.free : a.row < b.row; });
}

void Progress::update(const LaneCorridors& corridors, const RoutePlan& plan, glm::dvec2 p) {
  const double reach = 2.5 * corridors.body().radius;
  for (;;) {
    const RouteLeg& leg = plan.legs[leg_];
    const Way& way = corridors.way(leg.way);
    // Finds the nearest sample around the last position, then the foot of the perpendicular.
    const double was = leg.from + s_ - leg.start;
    double best = HUGE_VAL, at = was;
    const auto consider = [&](double s) {
      const glm::dvec2 d = point_on(way, s) - p;
      if (dot(d, d) >= best) return;
      best = dot(d, d);
      at = s;
    };
    const double low = std::max(was - 0.3 * reach, leg.from), high = std::min(was + reach, leg.to);
    for (double s = low; s < high; s += way.step) consider(s);
    consider(high);
    const double yaw = yaw_on(way, at);
    const double foot = at + dot(p - point_on(way, at), base::direction(yaw));
    if (foot < leg.to || leg_ + 1 >= plan.legs.size()) {
      s_ = leg.start + std::clamp(foot, leg.from, leg.to) - leg.from;
      // A cusp counts as reached within a tolerance.
      const bool there = leg.to - foot < 0.03 * reach && leg_ + 1 < plan.legs.size();
      if (!there || !cusp_after(corridors, plan, leg_)) return;
    }
    ++leg_;
    s_ = plan.legs[leg_].start;
    if (cusp_after(corridors, plan, leg_ - 1)) return;
  }
}

base::Twist steer(double speed, double offset, double heading, double curvature, double reach, double max_turn,
                  double turn_on_spot) {
  if (std::abs(heading) > turn_on_spot) return {0.0, 0.0, std::clamp(-2.0 * heading, -max_turn, max_turn)};
  const double sine = std::abs(heading) > 1e-6 ? base::sin(heading) / heading : 1.0;
  const double along = std::max(1.0 - curvature * offset, 0.3);
  // Far from the line the robot returns at no more than 45 degrees.
  const double off = std::clamp(offset, -1.2 * reach, 1.2 * reach);
  const double bend = curvature * base::cos(heading) / along - off * sine / (reach * reach) - 1.6 * heading / reach;
  const double v = std::abs(bend) * speed > max_turn ? max_turn / std::abs(bend) : speed;
  return {v, 0.0, v * bend};
}

}  // namespace sf::control
