// Partition of the points into work items: spans of magnets per group, split to a size, longest first, evenly
// distributed.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "gpu/group_counts.h"
#include "sensors/magnetic_field/tables.h"

namespace sf::sensors {

namespace {

using gpu::Role;
using gpu::Texel;

constexpr double kNoCutoff = 1e300;  // [m^2]

/// Loop iterations per bucket of the sort.
constexpr std::uint32_t kTurnsApart = kMostItemMagnets / 1024;

std::uint32_t ceiling(std::uint32_t a, std::uint32_t b) { return (a + b - 1) / b; }

/// Ensures that `table` holds `texels`, growing at least twofold. @return true for a new table, whose contents are
/// undefined
bool hold(std::unique_ptr<gpu::Buffer>& table, gpu::Device& device, const char* name, Role role, Texel texel,
          std::size_t texels) {
  if (table != nullptr && table->texels() >= texels) return false;
  const std::size_t had = table != nullptr ? table->texels() : 0;
  table.reset();
  table = std::make_unique<gpu::Buffer>(device, name, role, texel, std::max(texels, 2 * had));
  return true;
}

/// Splits spans longer than an item, in place, from the back. The array has room for it. @return the new number of
/// spans
std::uint32_t cut(std::span<MagnetSpan> spans, std::uint32_t count) {
  std::uint32_t pieces = 0;
  for (std::uint32_t i = 0; i < count; ++i) pieces += ceiling(spans[i].end - spans[i].first, kMostItemMagnets);
  std::uint32_t to = pieces;
  for (std::uint32_t i = count; i-- > 0;) {
    const MagnetSpan whole = spans[i];
    for (std::uint32_t piece = ceiling(whole.end - whole.first, kMostItemMagnets); piece-- > 0;) {
      const std::uint32_t first = whole.first + piece * kMostItemMagnets;
      spans[--to] = {first, std::min(first + kMostItemMagnets, whole.end)};
    }
  }
  return pieces;
}

}  // namespace

void MagneticField::Tables::gather(std::span<const FieldPoint> at, std::span<const std::uint32_t> ends) {
  point_groups.clear();
  double farthest = 0.0;
  std::uint32_t first = 0;
  for (const std::uint32_t end : ends) {
    PointGroup group;
    group.points = end - first;
    SF_CHECK(group.points >= 1 && group.points <= SF_FIELD_POINTS, std::to_string(group.points) + " places a group");
    for (std::uint32_t i = first; i < end; ++i)
      group.centre = group.centre + (1.0 / group.points) * glm::dvec2{at[i].x, at[i].y};
    for (std::uint32_t i = first; i < end; ++i)
      group.reach = std::max(group.reach, glm::length(glm::dvec2{at[i].x, at[i].y} - group.centre));
    // Rounding error of a centre far from the origin.
    const double slack = 1e-9 * cutoff + 1e-15 * (std::abs(group.centre.x) + std::abs(group.centre.y));
    group.reach += cutoff + slack;
    farthest = std::max(farthest, group.reach);
    point_groups.push_back(group);
    first = end;
  }
  stride = std::max(1u, fixed_grid.most_spans(farthest) + moving_grid.most_spans(farthest) +
                            (fixed_magnets + moving_magnets) / kMostItemMagnets);
  bound &= !hold(points, device, "places", Role::upload, Texel::u32x4,
                 gpu::texels_of<FieldPointRow>(SF_FIELD_POINTS * std::max<std::size_t>(1, ends.size())));
  // A lane that has summed its last span still reads the next one.
  bound &= !hold(spans, device, "spans of magnets", Role::upload, Texel::u32, 2 * (ends.size() * stride + 1));
}

void MagneticField::Tables::write_places(std::size_t group, std::span<const FieldPoint> at) {
  const auto rows = points->host<FieldPointRow>().subspan(group * SF_FIELD_POINTS, SF_FIELD_POINTS);
  const double cutoff_squared = cutoff > 0.0 ? cutoff * cutoff : kNoCutoff;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const FieldPoint& place = at[std::min(i, at.size() - 1)];
    rows[i] = {place.x, place.y, place.z, cutoff_squared};
  }
}

void MagneticField::Tables::find_spans(std::size_t group) {
  PointGroup& g = point_groups[group];
  const auto out = spans->host<MagnetSpan>().subspan(group * stride, stride);
  std::uint32_t count = fixed_grid.find(g.centre, g.reach, out);
  const std::uint32_t own = moving_grid.find(g.centre, g.reach, out.subspan(count));
  for (MagnetSpan& span : out.subspan(count, own)) span = {span.first + fixed_magnets, span.end + fixed_magnets};
  count += own;
  g.magnets = 0;
  for (const MagnetSpan& span : out.first(count)) g.magnets += span.end - span.first;
  g.spans = g.magnets > kMostItemMagnets ? cut(out, count) : count;
}

void MagneticField::Tables::plan_items() {
  planned.clear();
  const auto all = spans->host<MagnetSpan>();
  for (std::uint32_t g = 0; g < point_groups.size(); ++g) {
    PointGroup& group = point_groups[g];
    dipoles_summed += std::uint64_t{group.magnets} * group.points;
    group.item = static_cast<std::uint32_t>(planned.size());
    const std::uint32_t end = g * stride + group.spans;
    std::uint32_t span = g * stride;
    do {
      PlannedItem next{{span, span, g, static_cast<std::uint32_t>(planned.size())}, 0};
      for (std::uint32_t magnets = 0; span < end; ++span) {
        const std::uint32_t length = all[span].end - all[span].first;
        magnets += length;
        if (magnets > kMostItemMagnets) break;
        next.loop_turns += ceiling(length, SF_FIELD_UNROLL);
      }
      next.item.end = span;
      SF_CHECK(next.loop_turns <= kMostTurns, std::to_string(next.loop_turns) + " turns of an item");
      planned.push_back(next);
    } while (span < end);
    group.items = static_cast<std::uint32_t>(planned.size()) - group.item;
  }
}

/// Lanes of one group wait for the longest of them, so neighbours in the order have similar lengths.
void MagneticField::Tables::sort_items() {
  const auto bucket = [](const PlannedItem& p) { return 1023 - std::min(1023u, p.loop_turns / kTurnsApart); };
  lengths.fill(0);
  for (const PlannedItem& p : planned) ++lengths[bucket(p) + 1];
  std::partial_sum(lengths.begin(), lengths.end(), lengths.begin());
  sorted.resize(planned.size());
  for (std::uint32_t i = 0; i < planned.size(); ++i) sorted[lengths[bucket(planned[i])]++] = i;
}

/// Devices give each thread a fixed share of the groups, so long and short groups are interleaved over all shares by a
/// step of 0.618 of their number.
void MagneticField::Tables::write_items() {
  const auto count = static_cast<std::uint32_t>(planned.size());
  const std::uint32_t size = kernel->group_size();
  const std::uint32_t needed = ceiling(count, size);
  const gpu::GroupCounts dispatched = gpu::groups_for(count, size);
  const std::size_t lanes = dispatched.all() * size;
  bound &= !hold(items, device, "items of work", Role::upload, Texel::u32x4, std::max<std::size_t>(1, lanes));
  bound &= !hold(results, device, "fields", Role::download, Texel::u32x4,
                 gpu::texels_of<FieldSum>(SF_FIELD_POINTS * (std::size_t{count} + 1)));

  const auto table = items->host<FieldItem>();
  // Lanes without work write an empty sum to a result of their own.
  std::fill(table.begin(), table.begin() + static_cast<std::ptrdiff_t>(lanes), FieldItem{0, 0, 0, count});
  std::uint32_t step = static_cast<std::uint32_t>(0.618 * needed) + 1;
  while (std::gcd(step, needed) > 1) ++step;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint64_t dealt = std::uint64_t{i / size} * step % needed;
    table[dealt * size + i % size] = planned[sorted[i]].item;
  }
  gpu::write_counts(dispatched, *groups);
}

void MagneticField::Tables::bind() {
  kernel->bind({{"items", items.get()},
                {"spans", spans.get()},
                {"dipoles", dipoles.get()},
                {"places", points.get()},
                {"results", results.get()}});
  bound = true;
}

}  // namespace sf::sensors
