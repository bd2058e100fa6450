#include "scenarios/supervisor.h"

#include <cmath>

#include "base/elementary.h"

namespace sf::scenarios {

namespace {

constexpr double kApart = 0.01;           // [m] between stored poses
constexpr std::size_t kRemembered = 400;  // number of stored poses

double distance(const base::Pose& a, const base::Pose& b) { return base::hypot(a.x - b.x, a.y - b.y); }

/// Returns the side of the contact: positive if most of it is on the left.
double side_of(std::uint32_t contact_mask) {
  double side = 0.0;
  for (std::uint32_t k = 0; k < base::kContactSectors; ++k)
    if ((contact_mask >> k & 1u) != 0) side += base::sin(2.0 * M_PI * (k + 0.5) / base::kContactSectors);
  return side > 0.0 ? 1.0 : -1.0;
}

}  // namespace

Supervisor::Supervisor(const world::World& world, const SupervisorSettings& settings)
    : settings_(settings), interval_(world.interval), watched_(world.movers.size()) {}

std::span<const Supervisor::Intervention> Supervisor::update(const base::TickRecord& tick) {
  interventions_.clear();
  if (settings_.patience <= 0.0) return interventions_;
  for (std::uint32_t m = 0; m < watched_.size(); ++m) {
    Watched& watched = watched_[m];
    const base::Report& report = tick.reports[m];
    const bool waits = tick.contacts[m] != 0 && report.velocity.forward == 0.0 && report.velocity.turn == 0.0;
    watched.waited = waits ? watched.waited + interval_ : 0.0;
    if (tick.contacts[m] == 0 && (watched.way.empty() || distance(watched.way.back(), report.X_WM) >= kApart)) {
      if (watched.way.size() >= kRemembered) watched.way.erase(watched.way.begin());
      watched.way.push_back(report.X_WM);
    }
    if (watched.waited < settings_.patience) continue;
    interventions_.push_back({m, place_for(report, watched)});
    watched = {};
  }
  return interventions_;
}

base::Pose Supervisor::place_for(const base::Report& report, const Watched& watched) const {
  base::Pose place = report.X_WM;
  for (auto at = watched.way.rbegin(); at != watched.way.rend(); ++at) {
    place.x = at->x;
    place.y = at->y;
    if (distance(place, report.X_WM) >= settings_.back) break;
  }
  place.yaw = base::wrap_angle(report.X_WM.yaw - side_of(report.contact_mask) * settings_.turn);
  return place;
}

}  // namespace sf::scenarios
