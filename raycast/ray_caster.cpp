#include "raycast/ray_caster.h"

#include "raycast/ray_caster_tables.h"

namespace sf::raycast {

RayCaster::RayCaster(const SensorContext& context, const world::World& world, std::vector<Scanner> scanners)
    : t_(std::make_unique<Tables>(context, world, std::move(scanners))) {}

RayCaster::~RayCaster() = default;

const std::vector<Scanner>& RayCaster::scanners() const { return t_->plan.scanners; }
const BeamPlan& RayCaster::plan(std::uint32_t scanner) const { return t_->plan.rows[scanner].plan; }
std::uint32_t RayCaster::lane(std::uint32_t scanner) const { return t_->plan.rows[scanner].out; }
const Pose& RayCaster::X_WS(std::size_t i) const { return t_->views[i].X_WS; }
bool RayCaster::on_device() const { return t_->scene != nullptr; }
SensorStats RayCaster::stats() const {
  const Tables& t = *t_;
  const ScanCounts scans = t.host->counts();
  SensorStats stats{t.rays,
                    t.uncertain_beams + scans.uncertain,
                    t.host->cells_built(),
                    0,
                    scans.movers_in_range,
                    scans.movers_visible,
                    t.host_scans};
  if (!t.scene) return stats;
  const DeviceScene::Counts scene = t.scene->counts();
  stats.cells_built += scene.cells_built;
  stats.movers_in_range += scene.movers_in_range;
  stats.movers_visible += scene.movers_visible;
  return stats;
}

void RayCaster::place_movers() {
  t_->host_has_movers = false;
  if (t_->scene) t_->scene->place_movers(t_->states);
}

bool RayCaster::prepare(std::span<const DueSample> due, bool cast) {
  Tables& t = *t_;
  t.due.assign(due.begin(), due.end());
  t.views.resize(due.size());
  t.thread_pool.parallel_for(
      due.size(), 256, [&t](std::size_t first, std::size_t last, unsigned) { t.compute_viewpoints(first, last); });
  if (t.scene) t.begin_uncertain();
  const bool replaced = t.scene && t.prepare();
  t.uploads.write_lanes(due);
  // Scans on the host turn their beams themselves.
  if (t.scene || !cast) t.uploads.turn_all_beams(due, t.thread_pool);
  t.find_host_due();
  if (cast) t.scan_on_host();
  const bool rebind = replaced || !t.bound;
  if (rebind) t.bind();
  return rebind;
}

void RayCaster::record(gpu::Batch& batch) {
  if (!t_->scene) return;
  batch.dispatch(*t_->exact.kernel, t_->exact.lanes->groups, 0);
  if (t_->single) batch.dispatch(*t_->single->kernel, t_->single->lanes->groups, 0);
  batch.barrier();
  batch.dispatch(*t_->exact.uncertain_kernel, *t_->exact.uncertain, 0);
  if (t_->single) batch.dispatch(*t_->single->uncertain_kernel, *t_->single->uncertain, 0);
}

void RayCaster::add_copies(gpu::Batch& batch, bool results) {
  Tables& t = *t_;
  if (t.scene) {
    t.scene->upload(batch);
    batch.upload(*t.rows, 0, t.due.size() * sizeof(RayRow));
    const auto send = [&](const CastDispatch& pass) {
      batch.upload(*pass.uncertain, 0, sizeof(UncertainLanes));
      batch.download(*pass.uncertain, 0, pass.uncertain->bytes());
    };
    send(t.exact);
    if (t.single) send(*t.single);
  }
  t.uploads.add_copies(batch, t.due);
  for (const std::uint32_t i : t.host_due) t.results.upload(batch, t.plan.rows[t.due[i].row]);
  if (!t.scene || !results) return;
  // Scans with adjacent results are copied together.
  for (std::size_t i = 0; i < t.due.size();) {
    const std::size_t first = t.plan.rows[t.due[i].row].out;
    std::size_t lanes = 0;
    for (; i < t.due.size() && t.plan.rows[t.due[i].row].out == first + lanes; ++i)
      lanes += t.plan.rows[t.due[i].row].plan.lanes();
    batch.download(t.results.ranges, sizeof(LaneRanges) * first, sizeof(LaneRanges) * lanes);
    batch.download(t.results.hits, sizeof(LaneHits) * first, sizeof(LaneHits) * lanes);
  }
}

ScanResult RayCaster::results(std::size_t i) const {
  const ScannerRow& row = t_->plan.rows[t_->due[i].row];
  return {t_->due[i].row,      row.out, row.beams, &row.plan, &t_->plan.scanners[t_->due[i].row], t_->views[i].X_WS,
          t_->views[i].heading};
}

void RayCaster::take_flags() {
  if (!t_->scene) return;
  t_->take_uncertain(t_->exact);
  if (t_->single) t_->take_uncertain(*t_->single);
}

gpu::Buffer& RayCaster::ranges() { return t_->results.ranges; }
gpu::Buffer& RayCaster::hits() { return t_->results.hits; }
gpu::Buffer& RayCaster::directions64() { return t_->uploads.directions64(); }
std::span<const std::uint32_t> RayCaster::beam_flags() const { return t_->results.beam_flags; }
gpu::Buffer& RayCaster::lanes() { return t_->uploads.exact().lanes; }
gpu::Buffer& RayCaster::groups() { return t_->uploads.exact().groups; }

}  // namespace sf::raycast
