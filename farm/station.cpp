#include "farm/station.h"

#include <algorithm>

#include "farm/schedule.h"

namespace sf::farm {

Station::Station(const sensors::SensorContext& context, const sensors::SensorSet::Group& g)
    : group(&g), backend(g.kind->make(context)), steady(g.rows, context.noise), begun(g.rows.size(), 0) {
  for (const sensors::SensorSpec& row : g.rows) next.push_back(due_time(0, row.rate, row.phase));
  due.reserve(g.rows.size());
  looking.reserve(g.rows.size());
}

std::uint64_t Station::find_due(std::int64_t now, std::span<const std::uint32_t> heard) {
  due.clear();
  std::uint64_t missed = 0;
  const std::uint32_t kind = 1u << group->kind->id;
  // Sensors in a row mostly have one rate and phase.
  double rate = -1.0, phase = 0.0;
  std::uint64_t ready = 0, counted = 0;
  std::int64_t then = 0;
  for (std::uint32_t i = 0; i < begun.size(); ++i) {
    if (now < next[i] - 1) continue;
    const sensors::SensorSpec& row = group->rows[i];
    if (row.rate != rate || row.phase != phase) {
      rate = row.rate, phase = row.phase;
      ready = readings_begun(now, rate, phase);
      counted = ~std::uint64_t{0};
    }
    const std::uint64_t should = std::max(ready, begun[i] + (now >= next[i]));
    if (should <= begun[i]) continue;
    const std::uint64_t skipped = should - begun[i] - 1;
    begun[i] = should;
    if (should != counted) then = due_time(should, rate, phase);
    counted = should;
    next[i] = then;
    // A sensor's readings are numbered by when they are due: one that nobody heard leaves a gap, and its noise to
    // itself.
    if ((heard[row.mover] & kind) == 0) continue;
    due.push_back({i, should - 1});
    missed += skipped;
  }
  return missed;
}

std::int64_t Station::next_due(std::span<const std::uint32_t> heard) const {
  const std::uint32_t kind = 1u << group->kind->id;
  std::int64_t soonest = kNever;
  for (std::size_t i = 0; i < next.size(); ++i)
    if (next[i] < soonest && (heard[group->rows[i].mover] & kind) != 0) soonest = next[i];
  return soonest;
}

void Station::split(bool again) {
  looking.clear();
  for (const sensors::DueSample& d : due)
    if (!again || !steady.keeps(d.row)) looking.push_back(d);
}

bool Station::prepare(std::span<const base::Pose> poses) {
  const bool nothing = looking.empty();
  if (nothing && at_rest) return false;
  at_rest = nothing;
  in_use = true;
  told = false;
  return backend->prepare(looking, poses);
}

void Station::add_copies(gpu::Batch& batch) {
  if (told) return;
  backend->add_copies(batch);
  told = at_rest;
}

std::size_t Station::collect(std::int64_t now, std::span<const base::Pose> poses,
                             std::vector<base::ReadingBlock>& blocks) {
  const std::size_t first = blocks.size();
  backend->collect(blocks);
  // Readings that are given again take their places among those just taken, from the last one on.
  const std::size_t again = due.size() - looking.size();
  blocks.resize(first + due.size());
  std::size_t fresh = looking.size();
  for (std::size_t i = due.size(); again > 0 && i-- > 0;) {
    const bool looked = fresh > 0 && looking[fresh - 1].row == due[i].row;
    blocks[first + i] = looked ? blocks[first + --fresh] : steady.reading(due[i].row);
  }
  for (std::size_t i = 0; i < due.size(); ++i) {
    base::ReadingBlock& block = blocks[first + i];
    block.time = now;
    block.sequence = static_cast<std::uint32_t>(due[i].sequence);
    block.X_WM = poses[block.mover];
  }
  return again;
}

void Station::note(std::span<const base::ReadingBlock> blocks) {
  std::size_t i = blocks.size() - due.size();
  std::size_t looked = 0;
  for (const sensors::DueSample& d : due) {
    if (looked < looking.size() && looking[looked].row == d.row) {
      steady.taken(d.row, blocks[i]);
      ++looked;
    }
    ++i;
  }
}

}  // namespace sf::farm
