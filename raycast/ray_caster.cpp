#include "raycast/ray_caster.h"

#include <cmath>
#include <utility>

#include "base/elementary.h"
#include "raycast/scan_tables.h"

namespace sf::raycast {

RayCaster::RayCaster(const SensorContext& context, const world::World& world, std::vector<Scanner> scanners)
    : thread_pool_(context.thread_pool),
      states_(context.states),
      type_(choose_caster(context.device.info().software, context.scene.caster)),
      plan_(world, std::move(scanners), context.noise),
      uploads_(context, plan_),
      results_(context.device, plan_),
      caster_(type_.make({context, world, plan_, uploads_, results_})) {}

RayCaster::~RayCaster() = default;

SensorStats RayCaster::stats() const {
  SensorStats stats = caster_->stats();
  stats.rays = rays_;
  return stats;
}

bool RayCaster::prepare(std::span<const DueSample> due, bool cast) {
  due_.samples.assign(due.begin(), due.end());
  due_.views.resize(due.size());
  thread_pool_.parallel_for(due.size(), 256,
                            [this](std::size_t first, std::size_t last, unsigned) { find_views(first, last); });
  uploads_.write_lanes(due);
  const bool again = caster_->prepare(due_, cast);
  return std::exchange(fresh_, false) || again;
}

/// Computes the poses of the due scanners [first, last) as base::compose does, but with one sine and cosine per mover.
/// Counts their beams.
void RayCaster::find_views(std::size_t first, std::size_t last) {
  std::uint32_t mover = kNoMover;
  std::uint64_t beams = 0;
  glm::dvec2 turn;
  for (std::size_t i = first; i < last; ++i) {
    const ScannerRow& row = plan_.rows[due_.samples[i].row];
    const Pose &X = states_[row.mover].X_WM, &X_MS = row.mount;
    if (row.mover != mover) turn = base::direction(X.yaw);
    mover = row.mover;
    beams += row.plan.samples.size();
    const double yaw = X.yaw + X_MS.yaw;
    due_.views[i] = {
        row.config,
        mover,
        {X.x + (turn.x * X_MS.x - turn.y * X_MS.y), X.y + (turn.y * X_MS.x + turn.x * X_MS.y), X.z + X_MS.z, yaw},
        yaw == X.yaw ? turn : base::direction(yaw)};
  }
  rays_ += beams;
}

void RayCaster::add_copies(gpu::Batch& batch, bool results) {
  caster_->add_copies(batch, due_, results);
  uploads_.add_copies(batch, due_.samples);
}

ScanResult RayCaster::results(std::size_t i) const {
  const std::uint32_t number = due_.samples[i].row;
  const ScannerRow& row = plan_.rows[number];
  const Viewpoint& view = due_.views[i];
  return {number, row.out, row.beams, &row.plan, &plan_.scanners[number], view.X_WS, view.heading};
}

}  // namespace sf::raycast
