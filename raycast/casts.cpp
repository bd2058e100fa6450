#include "raycast/casts.h"

#include <bit>

#include "raycast/casts_tables.h"

namespace sf::raycast {

Casts::Casts(const Site& site, const world::World& world, std::vector<Fan> fans)
    : t_(std::make_unique<Tables>(site, world, std::move(fans))) {}

Casts::~Casts() = default;

const std::vector<Fan>& Casts::fans() const { return t_->fans; }
const BeamPlan& Casts::plan(std::uint32_t fan) const { return t_->fan_rows[fan].plan; }
bool Casts::on_device() const { return t_->scene != nullptr; }
Work Casts::work() const {
  const Tables& t = *t_;
  const ScanCounts scans = t.host->counts();
  Work work{t.rays,      t.doubts_seen + scans.doubts, t.host->cells_built(), 0, scans.movers_near, scans.movers_met,
            t.host_scans};
  if (!t.scene) return work;
  const Scene::Counts scene = t.scene->counts();
  work.cells_built += scene.cells_built;
  work.movers_near += scene.movers_near;
  work.movers_met += scene.movers_met;
  return work;
}

void Casts::place(std::span<const Pose> poses) {
  t_->poses.assign(poses.begin(), poses.end());
  t_->host_placed = false;
  if (t_->scene) t_->scene->place(poses);
}

bool Casts::prepare(std::span<const Due> due, std::span<const Pose> poses, bool cast) {
  Tables& t = *t_;
  t.due.assign(due.begin(), due.end());
  t.views.resize(due.size());
  t.thread_pool.parallel_for(due.size(), 256,
                             [&](std::size_t first, std::size_t last, unsigned) { t.look(first, last, poses); });
  for (const Due& d : due) t.rays += t.fan_rows[d.row].plan.samples.size();
  const bool replaced = t.scene && t.serve();
  t.write_lanes();
  if (t.scene && t.any_turns)
    t.thread_pool.parallel_for(due.size(), 1, [&t](std::size_t first, std::size_t last, unsigned thread) {
      for (std::size_t i = first; i < last; ++i)
        if (t.fan_rows[t.due[i].row].turns) t.turn_beams(t.due[i], thread);
    });
  t.find_for_host();
  if (cast) t.scan_on_host();
  const bool again = replaced || !t.bound;
  if (again) t.bind();
  return again;
}

void Casts::record(gpu::Batch& batch) {
  if (!t_->scene) return;
  batch.dispatch(*t_->exact.kernel, *t_->exact.groups, 0);
  if (t_->single) batch.dispatch(*t_->single->kernel, *t_->single->groups, 0);
}

void Casts::copies(gpu::Batch& batch, bool results) {
  Tables& t = *t_;
  if (t.scene) t.scene->upload(batch);
  if (t.scene) batch.upload(*t.rows, 0, t.due.size() * sizeof(RayRow));
  const auto send = [&](const CastPass& pass) {
    batch.upload(*pass.lanes, 0, pass.lanes->bytes());
    batch.upload(*pass.groups, 0, pass.groups->bytes());
  };
  send(t.exact);
  if (t.single) send(*t.single);
  if (t.beams_changed || t.any_turns) {
    batch.upload(*t.middles, 0, t.middles->bytes());
    batch.upload(*t.directions64, 0, t.directions64->bytes());
    t.beams_changed = false;
  }
  for (const std::uint32_t i : t.for_host) {
    const FanRow& row = t.fan_rows[t.due[i].row];
    const std::size_t lanes = row.plan.lanes();
    batch.upload(*t.ranges, 32 * std::size_t{row.out}, 32 * lanes);
    batch.upload(*t.hits, 16 * std::size_t{row.out}, 16 * lanes);
    batch.upload(*t.verdicts, 4 * std::size_t{row.out}, 4 * lanes);
  }
  batch.download(*t.verdicts, 0, t.verdicts->bytes());
  if (!results) return;
  batch.download(*t.ranges, 0, t.ranges->bytes());
  batch.download(*t.hits, 0, t.hits->bytes());
}

FanResults Casts::results(std::size_t i) const {
  const FanRow& row = t_->fan_rows[t_->due[i].row];
  return {t_->due[i].row,      row.out, row.beams, &row.plan, &t_->fans[t_->due[i].row], t_->views[i].X_WS,
          t_->views[i].heading};
}

void Casts::count() {
  if (!t_->scene) return;
  const auto verdicts = t_->verdicts->host<std::uint32_t>();
  for (const Due& due : t_->due) {
    const FanRow& row = t_->fan_rows[due.row];
    for (std::uint32_t lane = 0; lane < row.plan.lanes(); ++lane)
      t_->doubts_seen += static_cast<std::uint64_t>(std::popcount(verdicts[row.out + lane] / SF_DOUBT));
  }
}

gpu::Buffer& Casts::ranges() { return *t_->ranges; }
gpu::Buffer& Casts::hits() { return *t_->hits; }
gpu::Buffer& Casts::directions64() { return *t_->directions64; }
gpu::Buffer& Casts::verdicts() { return *t_->verdicts; }
gpu::Buffer& Casts::lanes() { return *t_->exact.lanes; }
gpu::Buffer& Casts::groups() { return *t_->exact.groups; }
std::uint32_t Casts::group_size() const { return kLanesPerGroup; }

}  // namespace sf::raycast
