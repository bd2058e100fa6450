#include "robots/fleet.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "robots/command_law.h"
#include "robots/motion.h"

namespace sf::robots {

namespace {

using base::Twist;
using world::Segment;

std::vector<Outline> outlines_of(const world::World& world) {
  std::vector<Outline> outlines;
  for (const world::Mover& mover : world.movers) outlines.push_back(outline_of(mover));
  return outlines;
}

std::vector<Segment> stopping(const world::World& world) {
  std::vector<Segment> walls;
  std::copy_if(world.walls.begin(), world.walls.end(), std::back_inserter(walls),
               [](const Segment& wall) { return wall.stops_robots; });
  return walls;
}

double median_radius(const std::vector<Outline>& outlines) {
  std::vector<double> radii;
  for (const Outline& outline : outlines) radii.push_back(outline.radius);
  if (radii.empty()) return 1.0;
  std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2), radii.end());
  return std::clamp(radii[radii.size() / 2], 0.05, 10.0);
}

}  // namespace

Fleet::Fleet(const world::World& world)
    : world_(world), outlines_(outlines_of(world)), walls_(stopping(world), 2.0 * median_radius(outlines_)) {
  const std::size_t count = world.movers.size();
  std::size_t edges = 0;
  for (std::uint32_t row = 0; row < count; ++row) {
    reports_.push_back({.mover = row, .time = 0, .X_WM = world.movers[row].X_WM, .velocity = {}});
    widest_ = std::max(widest_, outlines_[row].radius);
    edges = std::max(edges, outlines_[row].edges.size());
  }
  predicted_ = reports_;
  velocities_.resize(count);
  contacts_.resize(count);
  refused_.resize(count);
  struck_.resize(count);
  told_.resize(count);
  gone_.resize(count);
  for (auto* memory : {&next_, &now_, &other_}) memory->resize(edges);
  neighbours_.build(reports_, 1.0);
}

void Fleet::move(std::span<const Twist> commands, std::int64_t dt) {
  SF_CHECK(commands.size() == reports_.size(), std::to_string(commands.size()) + " commands");
  SF_CHECK(dt > 0, "dt " + std::to_string(dt));
  const double seconds = 1e-9 * static_cast<double>(dt);

  reach_ = {0.0, 0.0};
  for (std::size_t row = 0; row < commands.size(); ++row) {
    const world::Mover& mover = world_.movers[row];
    const Twist wanted = follow(mover, obey(mover, commands[row]));
    velocities_[row] = approach(mover, reports_[row].velocity, wanted, seconds);
    reach_.others = std::max(reach_.others, std::hypot(velocities_[row].forward, velocities_[row].left) * seconds);
  }
  neighbours_.build(reports_, 4.0 * (widest_ + reach_.others) + 1e-3);

  for (std::uint32_t row = 0; row < reports_.size(); ++row) {
    refused_[row] = 0;
    told_[row] = 0;
    move_one(row, velocities_[row], seconds);
    reports_[row].time += dt;
  }
  feel();
}

// What was refused a step touches something, and what touched may still: nobody else is looked at, but whom these
// were refused by.
void Fleet::feel() {
  for (std::uint32_t row = 0; row < reports_.size(); ++row) {
    contacts_[row] = refused_[row] != 0 || reports_[row].touched != 0;
    if (contacts_[row] != 0) reports_[row].touched = touch_of(row, reports_).sectors;
  }
  for (std::uint32_t row = 0; row < reports_.size(); ++row) {
    if (struck_[row] != 0 && contacts_[row] == 0) reports_[row].touched = touch_of(row, reports_).sectors;
    struck_[row] = 0;
    contacts_[row] = refused_[row] != 0 || reports_[row].touched != 0;
  }
}

std::size_t Fleet::apply(std::span<const base::Report> reports) {
  std::size_t taken = 0;
  for (const base::Report& report : reports) {
    SF_CHECK(report.mover < reports_.size(), "mover " + std::to_string(report.mover));
    if (report.time < reports_[report.mover].time) continue;
    reports_[report.mover] = report;
    reports_[report.mover].X_WM.z = world_.movers[report.mover].X_WM.z;
    told_[report.mover] = 1;
    refused_[report.mover] = 0;
    ++taken;
  }
  return taken;
}

std::span<const base::Report> Fleet::predict(std::int64_t time) {
  for (std::size_t row = 0; row < reports_.size(); ++row) {
    const base::Report& known = reports_[row];
    predicted_[row] = known;
    const std::int64_t ahead = std::clamp<std::int64_t>(time - known.time, 0, kCoast);
    if (ahead == 0) continue;
    predicted_[row].time = known.time + ahead;
    predicted_[row].X_WM = advance(known.X_WM, known.velocity, 1e-9 * static_cast<double>(ahead));
  }
  feel_told();
  return predicted_;
}

void Fleet::feel_told() {
  if (std::find(told_.begin(), told_.end(), 1) == told_.end()) return;
  reach_ = {kPressed, 0.0};
  neighbours_.build(predicted_, 4.0 * widest_ + 1e-3);
  for (std::uint32_t row = 0; row < predicted_.size(); ++row) {
    if (gone_[row] != 0) contacts_[row] = 0;
    if (told_[row] == 0 || gone_[row] != 0) continue;
    if (!clear(row, predicted_)) predicted_[row].touched |= touch_of(row, predicted_).sectors;
    contacts_[row] = predicted_[row].touched != 0;
  }
}

}  // namespace sf::robots
