#include "farm/sensor_pipeline.h"

#include <algorithm>
#include <cmath>

#include "farm/schedule.h"

namespace sf::farm {

namespace {

/// Returns start + time, or kNever. [ns]
std::int64_t later(std::int64_t start, std::int64_t time) { return time < kNever - start ? start + time : kNever; }

/// States no bound if no element has one, as for noisy readings.
void withdraw_bound(double sigma, base::ReadingBlock& block) {
  if (sigma > 0.0 && block.sigma == 0.0) block.sigma = sigma;
  const auto& flags = block.quality;
  const bool flagged = !flags.empty() && std::ranges::find(flags, base::QualityFlag::none) == flags.end();
  if (flagged) block.bound_without_noise = HUGE_VAL;
  if (flagged || block.sigma > 0.0) block.bound = HUGE_VAL;
}

}  // namespace

SensorPipeline::SensorPipeline(const sensors::SensorContext& context, const sensors::SensorSet::Group& g, bool measures)
    : group(&g),
      backend(measures ? g.type->make(context, g) : nullptr),
      cache(g.rows, context.noise),
      episodes(context.episodes) {
  for (std::uint32_t i = 0; i < g.rows.size(); ++i) {
    const sensors::SensorSpec& row = g.rows[i];
    if (timings.empty() || timings.back().rate != row.rate || timings.back().phase != row.phase ||
        !episodes.copies().meet(timings.back().mover, row.mover))
      timings.push_back({row.rate, row.phase, 0, due_time(0, row.rate, row.phase), i, i, row.mover});
    timings.back().end = i + 1;
    movers.push_back(row.mover);
  }
  const auto is_noisy = [](const sensors::SensorSpec& row) { return row.sigma > 0.0; };
  if (context.noise && std::ranges::any_of(g.rows, is_noisy))
    for (const sensors::SensorSpec& row : g.rows) sigmas.push_back(row.sigma);
  due.reserve(g.rows.size());
  to_measure.reserve(g.rows.size());
  blocks.reserve(g.rows.size());
}

void SensorPipeline::go_on(SensorPipeline* before, std::int64_t last_tick, std::int64_t last_call) {
  if (last_tick >= 0 && !computed()) backend->accumulate(last_tick, false);
  // Two steps suffice to find a past due time, because rounding may place it before its reading.
  const std::vector<base::SensorTypes> none(movers.empty() ? 0 : movers.back() + 1, 0u);
  for (int step = 0; step < 2 && last_call >= 0; ++step) find_due(last_call, none);
  due.clear();
  if (before == nullptr) return;
  const auto rows = static_cast<std::uint32_t>(before->movers.size());
  for (Timing& timing : timings)
    for (const Timing& old : before->timings)
      if (old.first == timing.first) timing.started = old.started, timing.next = old.next;
  if (!computed()) backend->take_over(*before->backend, rows);
}

void SensorPipeline::restart(std::uint32_t first, std::uint32_t end) {
  for (Timing& timing : timings) {
    if (timing.mover < first || timing.mover >= end) continue;
    timing.started = 0;
    timing.next = later(episodes.start_of(timing.mover), due_time(0, timing.rate, timing.phase));
  }
}

std::uint64_t SensorPipeline::find_due(std::int64_t now, std::span<const base::SensorTypes> subscribed) {
  due.clear();
  std::uint64_t missed = 0;
  const Timing* known = nullptr;  // the last one that was due
  Timing before{};
  for (Timing& timing : timings) {
    if (now < timing.next - 1) continue;
    const std::int64_t start = episodes.start_of(timing.mover);
    const bool same = known != nullptr && before.rate == timing.rate && before.phase == timing.phase &&
                      before.started == timing.started && before.next == timing.next &&
                      episodes.start_of(before.mover) == start;
    const std::uint64_t ready = same ? known->started : readings_started(now - start, timing.rate, timing.phase);
    const std::uint64_t should = std::max(ready, timing.started + (now >= timing.next));
    if (should <= timing.started) continue;
    const std::uint64_t skipped = should - timing.started - 1;
    before = timing;
    timing.next = same ? known->next : later(start, due_time(should, timing.rate, timing.phase));
    timing.started = should;
    known = &timing;
    // Sequence numbers follow due times: a reading without subscription leaves a gap, and its random numbers are not
    // used.
    for (std::uint32_t row = timing.first; row < timing.end; ++row) {
      if (!is_wanted(row, subscribed)) continue;
      due.push_back({row, should - 1});
      missed += skipped;
    }
  }
  return missed;
}

std::int64_t SensorPipeline::next_due(std::span<const base::SensorTypes> subscribed) const {
  std::int64_t soonest = kNever;
  for (const Timing& timing : timings) {
    if (timing.next >= soonest) continue;
    for (std::uint32_t row = timing.first; row < timing.end && timing.next < soonest; ++row)
      if (is_wanted(row, subscribed)) soonest = timing.next;
  }
  return soonest;
}

void SensorPipeline::split(bool reuse) {
  to_measure.clear();
  for (const sensors::DueSample& d : due)
    if (!reuse || !cache.has(d.row)) to_measure.push_back(d);
}

bool SensorPipeline::prepare() {
  const bool nothing = to_measure.empty();
  if (nothing && idle) return false;
  idle = nothing;
  active = true;
  uploaded = false;
  return backend->prepare(to_measure);
}

void SensorPipeline::add_copies(gpu::Batch& batch) {
  if (uploaded) return;
  backend->add_copies(batch);
  uploaded = idle;
}

std::size_t SensorPipeline::collect(std::int64_t now, std::span<const base::Report> states,
                                    base::ThreadPool& thread_pool) {
  blocks.resize(due.size());
  backend->collect(std::span(blocks).first(to_measure.size()));
  // Inserts reused readings among the measured ones, from the end backwards.
  const std::size_t again = due.size() - to_measure.size();
  std::size_t fresh = to_measure.size();
  for (std::size_t i = due.size(); i-- > fresh;) {
    const bool measured = fresh > 0 && to_measure[fresh - 1].row == due[i].row;
    blocks[i] = measured ? blocks[--fresh] : cache.reading(due[i].row);
  }
  thread_pool.parallel_for(due.size(), 256, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      base::ReadingBlock& block = blocks[i];
      block.time = now - episodes.start_of(block.mover);
      block.fused = false;
      block.sequence = static_cast<std::uint32_t>(due[i].sequence);
      block.X_WM = states[block.mover].X_WM;
      block.tilt = states[block.mover].tilt;
      withdraw_bound(sigmas.empty() ? 0.0 : sigmas[due[i].row], block);
    }
  });
  return again;
}

void SensorPipeline::store() {
  std::size_t i = 0;
  std::size_t measured = 0;
  for (const sensors::DueSample& d : due) {
    if (measured < to_measure.size() && to_measure[measured].row == d.row) {
      cache.store(d.row, blocks[i]);
      ++measured;
    }
    ++i;
  }
}

}  // namespace sf::farm
