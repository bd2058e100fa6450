#include "raycast/sectors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sf::raycast {

namespace {

constexpr double kSectorsPerRadian = SF_SECTORS / (2.0 * M_PI);

}  // namespace

bool clip(Vec2& a, Vec2& b, double reach) {
  const Vec2 e = b - a;
  const double ee = dot(e, e);
  const double middle = -dot(a, e) / ee;
  const Vec2 foot = a + middle * e;
  const double half_square = (reach * reach - dot(foot, foot)) / ee;
  if (half_square <= 0.0) return false;
  const double half = std::sqrt(half_square);
  const double u0 = std::max(0.0, middle - half);
  const double u1 = std::min(1.0, middle + half);
  if (u0 >= u1) return false;
  const Vec2 start = a;
  if (u1 < 1.0) b = start + u1 * e;
  if (u0 > 0.0) a = start + u0 * e;
  return true;
}

void SectorLists::clear() {
  candidates.clear();
  items.clear();
}

void SectorLists::add_interval(double low, double high) {
  const auto candidate = static_cast<std::uint32_t>(candidates.size() - 1);
  const double from = std::floor(low * kSectorsPerRadian);
  const double to = std::floor(high * kSectorsPerRadian);
  if (to - from >= SF_SECTORS - 1) return add_everywhere();
  for (double sector = from; sector <= to; ++sector)
    items.push_back({static_cast<std::uint32_t>(static_cast<int>(sector)) & (SF_SECTORS - 1), candidate});
}

void SectorLists::add_everywhere() {
  const auto candidate = static_cast<std::uint32_t>(candidates.size() - 1);
  for (std::uint32_t sector = 0; sector < SF_SECTORS; ++sector) items.push_back({sector, candidate});
}

void SectorLists::add_seen(const Candidate& candidate, double radius, double spread) {
  candidates.push_back(candidate);
  const double distance_a = length(candidate.a);
  const double distance_b = length(candidate.b);
  if (candidate.nearest <= 0.0 || distance_a <= radius || distance_b <= radius) return add_everywhere();
  const double bearing_a = std::atan2(candidate.a.y, candidate.a.x);
  const double bearing_b = bearing_a + std::atan2(cross(candidate.a, candidate.b), dot(candidate.a, candidate.b));
  const double wide_a = std::asin(radius / distance_a) + spread;
  const double wide_b = std::asin(radius / distance_b) + spread;
  add_interval(std::min(bearing_a - wide_a, bearing_b - wide_b), std::max(bearing_a + wide_a, bearing_b + wide_b));
}

std::uint32_t SectorLists::longest() const {
  std::uint32_t most = 0;
  for (std::uint32_t s = 0; s < SF_SECTORS; ++s) most = std::max(most, chunks(s));
  return most;
}

void SectorLists::sort() {
  std::fill(std::begin(first), std::end(first), 0u);
  for (const Item& item : items) ++first[item.sector + 1];
  for (std::uint32_t s = 0; s < SF_SECTORS; ++s) first[s + 1] += first[s];
  order.resize(items.size());
  std::uint32_t next[SF_SECTORS];
  std::copy(first, first + SF_SECTORS, next);
  for (const Item& item : items) order[next[item.sector]++] = item.candidate;
  const auto nearer = [this](std::uint32_t i, std::uint32_t k) {
    const Candidate &p = candidates[i], &q = candidates[k];
    if (p.facing != q.facing) return p.facing;
    return p.nearest != q.nearest ? p.nearest < q.nearest : i < k;
  };
  for (std::uint32_t s = 0; s < SF_SECTORS; ++s) {
    const auto begin = order.begin() + first[s], end = order.begin() + first[s + 1];
    std::sort(begin, end, nearer);
    behind[s] = first[s] + static_cast<std::uint32_t>(
                               std::count_if(begin, end, [this](std::uint32_t i) { return candidates[i].facing; }));
  }
}

std::uint32_t SectorLists::all_chunks() const {
  std::uint32_t sum = 0;
  for (std::uint32_t s = 0; s < SF_SECTORS; ++s) sum += chunks(s);
  return sum;
}

void collect(const Sight& sight, const CellShape& shape, Vec2 centre, bool both_sides, Sight::Nearby& nearby,
             SectorLists& lists) {
  lists.clear();
  const double radius = shape.radius();
  sight.near(centre, shape.reach(), nearby);
  for (const std::uint32_t i : nearby.found) {
    const SightSegment& s = sight.segments()[i];
    Candidate candidate{s.a - centre, s.b - centre, 0.0, s.row};
    if (!clip(candidate.a, candidate.b, shape.reach())) continue;
    candidate.nearest = std::max(0.0, world::distance({}, candidate.a, candidate.b) - radius);

    // The cell's signed distance from the segment's line: positive on its left.
    const Vec2 e = s.b - s.a;
    const double side = cross(e, centre - s.a) / length(e);
    const bool both = both_sides || !s.solid_left;
    candidate.facing = side < radius;
    if (side < radius || !both) lists.add_seen(candidate, radius, shape.spread);
    if (side <= -radius || !both) continue;
    std::swap(candidate.a, candidate.b);
    candidate.facing = true;
    lists.add_seen(candidate, radius, shape.spread);
  }
  lists.sort();
}

std::uint32_t list_word(std::uint32_t row, float clearance) {
  if (clearance <= 0.0f) return row | std::uint32_t{SF_NO_CLEARANCE} << SF_ROW_BITS;
  int exponent = 0;
  std::frexp(clearance, &exponent);  // 2^(exponent - 1) <= clearance
  const auto code = static_cast<std::uint32_t>(std::clamp(1 - exponent, 0, SF_NO_CLEARANCE));
  return row | code << SF_ROW_BITS;
}

namespace {

/// Writes entries [at, end) of `lists.order` to chunks from `chunk` on; gives the next chunk.
std::uint32_t write_chunks(const SectorLists& lists, std::uint32_t at, std::uint32_t end, std::uint32_t chunk,
                           const ListTables& tables) {
  for (; at < end; at += SF_CHUNK, ++chunk) {
    tables.nearest[chunk] = std::nextafter(static_cast<float>(lists.candidates[lists.order[at]].nearest), 0.0f);
    for (std::uint32_t k = 0; k < SF_CHUNK; ++k) {
      ListEntry& entry = tables.entries[chunk * SF_CHUNK + k];
      std::uint32_t& id = tables.ids[chunk * SF_CHUNK + k];
      if (at + k >= end) {
        // Far behind every viewpoint: in front of nothing.
        entry = {0.0f, -1e30f, 1.0f, 0.0f};
        id = SF_NO_HIT;
        continue;
      }
      const Candidate& c = lists.candidates[lists.order[at + k]];
      const Vec2 e = c.b - c.a;
      entry = {static_cast<float>(c.a.x), static_cast<float>(c.a.y), static_cast<float>(e.x), static_cast<float>(e.y)};
      id = tables.words[c.id];
    }
  }
  return chunk;
}

}  // namespace

void write_lists(const SectorLists& lists, std::uint32_t first_chunk, const ListTables& tables, ListHeader* headers) {
  std::uint32_t chunk = first_chunk;
  for (std::uint32_t sector = 0; sector < SF_SECTORS; ++sector) {
    const std::uint32_t facing = lists.chunks_facing(sector);
    headers[sector] = {chunk, facing, std::numeric_limits<float>::infinity(), lists.chunks(sector) - facing};
    chunk = write_chunks(lists, lists.first[sector], lists.behind[sector], chunk, tables);
    chunk = write_chunks(lists, lists.behind[sector], lists.first[sector + 1], chunk, tables);
  }
}

}  // namespace sf::raycast
