#include "raycast/cast_uploads.h"

#include <algorithm>

#include "gpu/group_counts.h"

namespace sf::raycast {

namespace {

LaneTable make_lanes(gpu::Device& device, const CastPlan& plan) {
  using gpu::Role;
  using gpu::Texel;
  // Lanes are padded to whole groups, and large numbers of groups to whole rows of groups.
  const std::size_t padded = gpu::most_groups_for(plan.result_lanes, SF_LANES_PER_GROUP) * SF_LANES_PER_GROUP;
  return {{device, "whose beams", Role::upload, Texel::u32, 2 * padded},
          {device, "group counts", Role::upload, Texel::u32, 4}};
}

}  // namespace

CastUploads::CastUploads(const SensorContext& context, const CastPlan& plan)
    : plan_(plan),
      episodes_(context.episodes),
      mid_bearings_(context.device, "middles of lanes", gpu::Role::upload, gpu::Texel::f32,
                    std::size_t{plan.beam_lanes} + 1),
      directions64_(context.device, "beams in 64 bits", gpu::Role::upload, gpu::Texel::u32x4,
                    gpu::texels_of<BeamDirection>(SF_BEAMS_PER_LANE * (std::size_t{plan.beam_lanes} + 1))),
      exact_(make_lanes(context.device, plan)),
      angle_offsets_(context.thread_pool.threads()) {
  const auto is_single = [](const Scanner& scanner) { return scanner.single; };
  if (std::any_of(plan.scanners.begin(), plan.scanners.end(), is_single))
    single_.emplace(make_lanes(context.device, plan));
  write_all_beams();
}

void CastUploads::write_all_beams() {
  // Tables were allocated in order of rows, so a table after all written ones is new, and others are shared.
  std::uint32_t written = 0;
  for (std::size_t i = 0; i < plan_.scanners.size(); ++i) {
    const ScannerRow& row = plan_.rows[i];
    if (row.beams < written) continue;
    write_beams(plan_.scanners[i].scan, row.plan, {}, beam_tables(row.beams));
    written += row.plan.lanes();
  }
}

std::span<const double> CastUploads::turn_beams(const DueSample& due, unsigned thread) {
  const Scanner& scanner = plan_.scanners[due.row];
  const ScannerRow& row = plan_.rows[due.row];
  std::vector<double>& angle_noise = angle_offsets_[thread];
  angle_noise.resize(row.plan.samples.size());
  draw_angle_noise(scanner.scan, row.plan,
                   episodes_.key(base::RandomStream::angle_noise, scanner.mover, scanner.sensor, due.sequence),
                   angle_noise);
  write_beams(scanner.scan, row.plan, angle_noise, beam_tables(row.beams));
  return angle_noise;
}

void CastUploads::turn_all_beams(std::span<const DueSample> due, base::ThreadPool& thread_pool) {
  if (!plan_.any_angle_noise) return;
  thread_pool.parallel_for(due.size(), 1, [&](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t i = first; i < last; ++i)
      if (plan_.rows[due[i].row].angle_noise) turn_beams(due[i], thread);
  });
}

void CastUploads::write_lanes(std::span<const DueSample> due) {
  // The contents of new tables are undefined, so the first tick writes them even if no sensor is due.
  const bool same = any_lanes_ && std::equal(due.begin(), due.end(), lanes_written_.begin(), lanes_written_.end(),
                                             [](const DueSample& d, std::uint32_t row) { return d.row == row; });
  if (same) return;
  any_lanes_ = lanes_changed_ = true;
  lanes_written_.clear();
  for (const DueSample& d : due) lanes_written_.push_back(d.row);
  write_lanes(due, false, exact_);
  if (single_) write_lanes(due, true, *single_);
}

void CastUploads::write_lanes(std::span<const DueSample> due, bool is_single, LaneTable& into) {
  const auto table = into.lanes.host<Lane>();
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < due.size(); ++i) {
    if (plan_.rows[due[i].row].single != is_single) continue;
    for (std::uint32_t lane = 0; lane < plan_.rows[due[i].row].plan.lanes(); ++lane) table[at++] = {i, lane};
  }
  const gpu::GroupCounts groups = gpu::groups_for(at, SF_LANES_PER_GROUP);
  // Padding repeats the last lane, whose results are then written several times with equal values.
  const Lane last = at > 0 ? table[at - 1] : Lane{0, 0};
  std::fill(table.begin() + static_cast<std::ptrdiff_t>(at),
            table.begin() + static_cast<std::ptrdiff_t>(SF_LANES_PER_GROUP * groups.all()), last);
  gpu::write_counts(groups, into.groups);
}

void CastUploads::add_copies(gpu::Batch& batch, std::span<const DueSample> due) {
  const auto send = [&](LaneTable& table) {
    const auto counts = table.groups.host<std::uint32_t>();
    batch.upload(table.lanes, 0, sizeof(Lane) * SF_LANES_PER_GROUP * counts[0] * counts[1]);
    batch.upload(table.groups, 0, table.groups.bytes());
  };
  if (lanes_changed_) send(exact_);
  if (lanes_changed_ && single_) send(*single_);
  if (beams_changed_) {
    batch.upload(mid_bearings_, 0, mid_bearings_.bytes());
    batch.upload(directions64_, 0, directions64_.bytes());
  } else if (plan_.any_angle_noise) {
    for (const DueSample& d : due) {
      const ScannerRow& row = plan_.rows[d.row];
      if (!row.angle_noise) continue;
      batch.upload(mid_bearings_, sizeof(float) * row.beams, sizeof(float) * row.plan.lanes());
      const std::size_t lane = SF_BEAMS_PER_LANE * sizeof(BeamDirection);
      batch.upload(directions64_, lane * row.beams, lane * row.plan.lanes());
    }
  }
  lanes_changed_ = beams_changed_ = false;
}

}  // namespace sf::raycast
