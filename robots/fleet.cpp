#include "robots/fleet.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "robots/fleet_rules.h"
#include "robots/kinematics.h"

namespace sf::robots {

namespace {

using base::Twist;
using world::Segment;

std::vector<Footprint> footprints_of(const world::World& world) {
  std::vector<Footprint> outlines;
  for (const world::Mover& mover : world.movers) outlines.push_back(footprint_of(mover));
  return outlines;
}

std::vector<Segment> stopping(const world::World& world) {
  std::vector<Segment> walls;
  walls.reserve(world.walls.size());
  std::copy_if(world.walls.begin(), world.walls.end(), std::back_inserter(walls),
               [](const Segment& wall) { return wall.stops_robots; });
  return walls;
}

/// Returns the tilt of a mover on terrain. Wheels are as far apart along a robot without a wheelbase as across.
base::Tilt tilt_of(const world::Ground& ground, const world::Mover& mover, const base::Pose& X_WM) {
  if (mover.is_tag || !ground.has_terrain()) return {};
  return ground.tilt(X_WM, mover.drive == world::Drive::car ? mover.wheelbase : mover.track, mover.track);
}

}  // namespace

std::vector<base::Report> states_at_load(const world::World& world) {
  const world::Ground ground({}, world.terrain);
  std::vector<base::Report> states;
  for (const world::Mover& mover : world.movers)
    states.push_back({.mover = static_cast<std::uint32_t>(states.size()),
                      .X_WM = mover.X_WM,
                      .velocity = {},
                      .tilt = tilt_of(ground, mover, mover.X_WM)});
  return states;
}

Fleet::Fleet(const world::World& world, base::ThreadPool* thread_pool)
    : world_(world),
      thread_pool_(thread_pool),
      footprints_(footprints_of(world)),
      walls_(stopping(world)),
      ground_(world.ramps, world.terrain),
      copies_(world),
      reports_(states_at_load(world)),
      predicted_(reports_),
      rank_(ranks_of(world)),
      scratch_(thread_pool != nullptr ? thread_pool->threads() : 1) {
  make_room();
  neighbours_.build(reports_, 1.0, copies_);
  for (std::uint32_t row = 0; row < reports_.size(); ++row) add_dynamics(row);
}

void Fleet::add_mover() {
  const std::size_t row = reports_.size();
  SF_CHECK(row + 1 == world_.movers.size(), std::to_string(row));
  footprints_.push_back(footprint_of(world_.movers[row]));
  reports_.push_back({.mover = static_cast<std::uint32_t>(row),
                      .time = reports_.empty() ? 0 : reports_.front().time,
                      .X_WM = world_.movers[row].X_WM,
                      .velocity = {},
                      .tilt = tilt_of(ground_, world_.movers[row], world_.movers[row].X_WM)});
  predicted_ = reports_;
  rank_ = ranks_of(world_);
  disturbed_ = true;
  make_room();
  add_dynamics(static_cast<std::uint32_t>(row));
}

void Fleet::restart(std::uint32_t row) {
  const base::Pose& X_WM = world_.movers[row].X_WM;
  reports_[row] = {.mover = row,
                   .time = reports_[row].time,
                   .X_WM = X_WM,
                   .velocity = {},
                   .tilt = tilt_of(ground_, world_.movers[row], X_WM)};
  predicted_[row] = reports_[row];
  free_discs_[row] = {};
  if (is_dynamic(row)) bodies_[row].dynamics->place(reports_[row], bodies_[row].state);
  for (auto* flags : {&contacts_, &refused_, &struck_, &reported_}) (*flags)[row] = 0;
  disturbed_ = true;
}

void Fleet::update_outlines(std::span<const std::uint32_t> rows) {
  for (const std::uint32_t row : rows) {
    footprints_.at(row) = footprint_of(world_.movers[row]);
    free_discs_[row] = {};
  }
  disturbed_ = true;
  make_room();
}

/// Resizes everything for all movers, so that ticks do not allocate.
void Fleet::make_room() {
  const std::size_t count = reports_.size();
  std::size_t edges = 0;
  widest_ = 0.0;
  for (std::uint32_t row = 0; row < count; ++row) {
    widest_ = std::max(widest_, footprints_[row].radius);
    edges = std::max(edges, footprints_[row].edges.size());
  }
  travels_.resize(count);
  starts_.resize(ground_.is_flat() ? 0 : count);
  if (!bodies_.empty()) bodies_.resize(count);
  progress_.resize(count);
  proposed_.resize(count);
  free_discs_.resize(count);
  nearby_.resize(count);
  for (auto* flags :
       {&waiting_, &yielded_, &changed_, &moved_, &continues_, &contacts_, &refused_, &struck_, &reported_, &absent_})
    flags->resize(count);
  for (auto* rows : {&unfinished_, &round_rows_}) rows->reserve(count);
  for (Scratch& scratch : scratch_) {
    scratch.next.resize(edges), scratch.now.edges.resize(edges), scratch.now.row = world::kNone;
    for (Placed& other : scratch.others) other.edges.resize(edges), other.row = world::kNone;
    for (auto* rows : {&scratch.near, &scratch.all_near, &scratch.priority_movers}) rows->reserve(count);
    scratch.walls.reserve(1'000);
  }
}

void Fleet::move(std::span<const Twist> commands, std::int64_t dt) {
  SF_CHECK(commands.size() == reports_.size(), std::to_string(commands.size()) + " commands");
  SF_CHECK(dt > 0, "dt " + std::to_string(dt));
  const double seconds = 1e-9 * static_cast<double>(dt);
  require_dynamics();

  for (Scratch& scratch : scratch_) scratch.farthest = 0.0;
  for_rows(commands.size(), [&](std::uint32_t row, Scratch& scratch) { start(row, commands[row], seconds, scratch); });
  farthest_ = 0.0;
  for (const Scratch& scratch : scratch_) farthest_ = std::max(farthest_, scratch.farthest);
  neighbours_.build(reports_, 4.0 * (widest_ + farthest_) + 1e-3, copies_);

  unfinished_.clear();
  for (std::uint32_t row = 0; row < reports_.size(); ++row)
    if (waiting_[row] != 0) unfinished_.push_back(row);
  std::fill(changed_.begin(), changed_.end(), 0);
  round_rows_.assign(unfinished_.begin(), unfinished_.end());
  for (int k = 1; k < kRounds && !round_rows_.empty(); ++k) {
    run_round(false);
    find_next();
  }
  round_rows_.assign(unfinished_.begin(), unfinished_.end());
  run_round(true);

  for_rows(reports_.size(), [&](std::uint32_t row, Scratch&) {
    const Progress& progress = progress_[row];
    refused_[row] = progress.refused || progress.left > 0.0;
    reports_[row].velocity = progress.left > 0.0 ? Twist{} : progress.velocity;
    reports_[row].time += dt;
    contacts_[row] = absent_[row] == 0 && (refused_[row] != 0 || reports_[row].contact_mask != 0);
    if (is_dynamic(row) && absent_[row] == 0) return place_body(row);
    if (ground_.is_flat() || absent_[row] != 0) return;
    const double z = ground_.follow(starts_[row], {reports_[row].X_WM.x, reports_[row].X_WM.y});
    if (z != std::exchange(reports_[row].X_WM.z, z)) moved_[row] = 1;
    if (ground_.has_terrain()) reports_[row].tilt = tilt_of(ground_, world_.movers[row], reports_[row].X_WM);
  });
  update_contacts();
}

// Only movers with a refused step, movers in contact before (both are set in `contacts_`), and movers that refused a
// step can be in contact. Tests only these.
void Fleet::update_contacts() {
  for_rows(reports_.size(), [&](std::uint32_t row, Scratch&) {
    const auto struck = refused_[row] != 0 ? std::span(struck_) : std::span<std::uint8_t>();
    if (contacts_[row] != 0 && !keeps_contacts(row))
      reports_[row].contact_mask = body_contact(row, reports_[row].X_WM, reports_, struck).sectors;
  });
  for_rows(reports_.size(), [&](std::uint32_t row, Scratch&) {
    if (struck_[row] != 0 && contacts_[row] == 0)
      reports_[row].contact_mask = body_contact(row, reports_[row].X_WM, reports_).sectors;
    struck_[row] = 0;
    contacts_[row] = absent_[row] == 0 && (refused_[row] != 0 || reports_[row].contact_mask != 0);
  });
  disturbed_ = false;
}

std::uint64_t Fleet::steps_tested() const {
  std::uint64_t sum = 0;
  for (const Scratch& scratch : scratch_) sum += scratch.tested;
  return sum;
}

std::size_t Fleet::apply(std::span<const base::Report> reports) {
  std::size_t taken = 0;
  for (const base::Report& report : reports) {
    SF_CHECK(report.mover < reports_.size(), "mover " + std::to_string(report.mover));
    if (report.time < reports_[report.mover].time) continue;
    reports_[report.mover] = report;
    reported_[report.mover] = 1;
    refused_[report.mover] = 0;
    disturbed_ = true;
    ++taken;
  }
  return taken;
}

void Fleet::set_moved(const base::Report& report, bool contact) {
  reports_[report.mover] = report;
  contacts_[report.mover] = contact ? 1 : 0;
  disturbed_ = true;
}

std::span<const base::Report> Fleet::predict(std::int64_t time) {
  for (std::size_t row = 0; row < reports_.size(); ++row) predicted_[row] = extrapolate(reports_[row], time);
  update_reported_contacts();
  return predicted_;
}

void Fleet::update_reported_contacts() {
  if (std::find(reported_.begin(), reported_.end(), 1) == reported_.end()) return;
  farthest_ = 0.0;
  neighbours_.build(predicted_, 4.0 * widest_ + 1e-3, copies_);
  for_rows(predicted_.size(), [&](std::uint32_t row, Scratch&) {
    if (absent_[row] != 0) contacts_[row] = 0;
    if (reported_[row] == 0 || absent_[row] != 0) return;
    nearby_[row] = {};
    base::Report& report = predicted_[row];
    if (!clear(row, predicted_, kContactDistance))
      report.contact_mask |= body_contact(row, report.X_WM, predicted_).sectors;
    contacts_[row] = report.contact_mask != 0;
  });
}

}  // namespace sf::robots
