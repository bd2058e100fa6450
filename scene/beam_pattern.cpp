#include "scene/beam_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "base/elementary.h"

namespace sf::scene {

namespace {

/// Smallest cosine between a box's axis and its beams: wider groups are split.
constexpr double kLeastCosine = 0.6;

struct DirectionBox {
  glm::dvec3 c, U, V, axis;
  std::array<glm::dvec3, 4> plane;
  double longest = 0.0;
  double area = HUGE_VAL;
};

/// Returns the box of beams with one side along a unit vector across their axis. @param beam returns the i-th of them
template <class Beam>
DirectionBox box_along(glm::dvec3 side, glm::dvec3 axis, std::size_t count, const Beam& beam) {
  const std::array<glm::dvec3, 2> sides{side, glm::cross(axis, side)};
  std::array<double, 2> low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 d = beam(i) / glm::dot(beam(i), axis);
    for (int k = 0; k < 2; ++k)
      low[k] = std::min(low[k], glm::dot(d, sides[k])), high[k] = std::max(high[k], glm::dot(d, sides[k]));
  }
  for (int k = 0; k < 2; ++k) {  // room for the rounding of rotated beams and boxes
    const double room = 3e-6 * (1.0 + high[k] - low[k]);
    low[k] -= room, high[k] += room;
  }
  DirectionBox box{.axis = axis, .area = (high[0] - low[0]) * (high[1] - low[1])};
  box.c = axis + sides[0] * (0.5 * (low[0] + high[0])) + sides[1] * (0.5 * (low[1] + high[1]));
  box.U = sides[0] * (0.5 * (high[0] - low[0])), box.V = sides[1] * (0.5 * (high[1] - low[1]));
  return box;
}

/// Completes a box by its sides.
void add_planes(DirectionBox& box) {
  const std::array<glm::dvec3, 4> corners{box.c - box.U - box.V, box.c + box.U - box.V, box.c + box.U + box.V,
                                          box.c - box.U + box.V};
  for (int k = 0; k < 4; ++k) {
    box.plane[k] = glm::normalize(glm::cross(corners[k], corners[(k + 1) % 4]));
    if (glm::dot(box.plane[k], box.axis) < 0.0) box.plane[k] = -box.plane[k];
    box.longest = std::max(box.longest, glm::length(corners[k]));
  }
}

/// Returns a horizontal unit vector across an axis.
glm::dvec3 level_side(glm::dvec3 axis) {
  return glm::normalize(glm::cross(std::abs(axis.z) < 0.9 ? glm::dvec3{0, 0, 1} : glm::dvec3{1, 0, 0}, axis));
}

/// Returns the unit vector across an axis from one beam to another, or `level` for equal beams.
glm::dvec3 side_along(glm::dvec3 axis, glm::dvec3 from, glm::dvec3 to, glm::dvec3 level) {
  glm::dvec3 along = to - from;
  along -= axis * glm::dot(along, axis);
  return glm::length(along) > 1e-6 ? glm::normalize(along) : level;
}

void write_beam(glm::dvec3 d, std::uint32_t place, std::uint32_t at, BeamTile& tile) {
  tile.dx[at] = d.x, tile.dy[at] = d.y, tile.dz[at] = d.z;
  tile.x[at] = static_cast<float>(d.x), tile.y[at] = static_cast<float>(d.y), tile.z[at] = static_cast<float>(d.z);
  tile.place[at] = place;
}

class Grouping {
 public:
  Grouping(std::span<const glm::dvec3> directions, std::uint32_t row) : directions_(directions), row_(row) {
    order_.resize(directions.size());
    std::iota(order_.begin(), order_.end(), 0u);
    for (const glm::dvec3& d : directions)
      angles_.push_back({base::atan2(d.y, d.x), base::atan2(d.z, base::hypot(d.x, d.y))});
  }
  /// @param times as make_pattern's
  BeamPattern make(std::span<const double> times);
  BeamPattern make_image(std::uint32_t width);

 private:
  using Range = std::pair<std::size_t, std::size_t>;
  void split(Range range, std::uint32_t size, double tall, std::vector<Range>& out);
  std::size_t bisect(Range range, std::uint32_t size, double tall);
  void sort_by_key();
  bool narrow(Range range, double cosine) const;
  double tile_weight() const;
  glm::dvec3 mean(Range range) const;
  DirectionBox box_of(Range range) const;
  void write_tile(std::span<const Range> vectors, BeamTile& tile) const;
  void write_tiles(std::span<const Range> vectors, double time, BeamPattern& pattern);
  std::vector<Range> equal_times(std::span<const double> times);

  std::span<const glm::dvec3> directions_;
  std::uint32_t row_;
  bool along_row() const { return row_ >= kWidth; }
  std::vector<std::uint32_t> order_;
  std::vector<std::array<double, 2>> angles_;  ///< [rad] azimuth and elevation
  struct Keyed {
    std::int32_t key;
    std::uint32_t beam;
  };
  std::vector<Keyed> keyed_, sorted_;  ///< scratch memory
};

glm::dvec3 Grouping::mean(Range range) const {
  glm::dvec3 sum{};
  for (std::size_t i = range.first; i < range.second; ++i) sum += directions_[order_[i]];
  return glm::length(sum) > 0.0 ? glm::normalize(sum) : glm::dvec3{1.0, 0.0, 0.0};
}

bool Grouping::narrow(Range range, double cosine) const {
  const glm::dvec3 axis = mean(range);
  return std::all_of(order_.begin() + range.first, order_.begin() + range.second,
                     [&](std::uint32_t i) { return glm::dot(directions_[i], axis) >= cosine; });
}

/// Returns the weight of a tile's height against its width: tiles of sparse rings are wide (measured on 16 x 1 800).
double Grouping::tile_weight() const {
  const std::size_t rings = along_row() ? directions_.size() / row_ : 1;
  if (rings < 2) return 1.0;
  const auto extent = [&](int side) {
    const auto [low, high] = std::ranges::minmax(angles_, {}, [side](const auto& a) { return a[side]; });
    return high[side] - low[side];
  };
  const double ring = extent(1) / static_cast<double>(rings - 1), column = extent(0) / row_;
  return std::clamp(0.5 * ring / column, 1.0, 8.0);
}

/// Appends groups of at most `size` beams that are narrow enough for a box.
/// @param tall weight of their height against their width
void Grouping::split(Range range, std::uint32_t size, double tall, std::vector<Range>& out) {
  const std::size_t count = range.second - range.first;
  if (count <= size && narrow(range, kLeastCosine)) return out.push_back(range);
  const std::size_t middle = bisect(range, count > size ? size : 1, tall);
  split({range.first, middle}, size, tall, out);
  split({middle, range.second}, size, tall, out);
}

/// Sorts a group by its longer side. @return where to cut it, a multiple of `size` after its start
std::size_t Grouping::bisect(Range range, std::uint32_t size, double tall) {
  // Far from the poles by azimuth and elevation, so that rings stay together; else in the tangent plane.
  const glm::dvec3 axis = mean(range);
  const bool polar = std::any_of(order_.begin() + range.first, order_.begin() + range.second,
                                 [&](std::uint32_t i) { return std::abs(angles_[i][1]) > 1.4; });
  const bool tangent = polar && narrow(range, 0.9);
  const glm::dvec3 aside =
      std::abs(axis.z) < 0.99 ? glm::normalize(glm::cross({0.0, 0.0, 1.0}, axis)) : glm::dvec3{1, 0, 0};
  const glm::dvec3 up = glm::cross(axis, aside);
  const auto key = [&](std::uint32_t i, int side) {
    return tangent ? glm::dot(directions_[i], side == 0 ? aside : up) : angles_[i][side];
  };
  std::array<double, 2> extent{};
  for (int side = 0; side < 2; ++side) {
    const auto less = [&](std::uint32_t i, std::uint32_t j) { return key(i, side) < key(j, side); };
    const auto [low, high] = std::minmax_element(order_.begin() + range.first, order_.begin() + range.second, less);
    extent[side] = key(*high, side) - key(*low, side);
  }
  const int side = tall * extent[1] > extent[0] ? 1 : 0;
  keyed_.clear();
  for (std::size_t i = range.first; i < range.second; ++i)  // rounded, so that rings stay together
    keyed_.push_back({static_cast<std::int32_t>(std::lround(1e6 * key(order_[i], side))), order_[i]});
  sort_by_key();
  for (std::size_t i = range.first; i < range.second; ++i) order_[i] = keyed_[i - range.first].beam;
  const std::size_t units = (range.second - range.first + size - 1) / size;
  return range.first + units / 2 * size;
}

/// Sorts `keyed_` in linear time where it is long; equal keys keep their order.
void Grouping::sort_by_key() {
  constexpr std::size_t kFew = 1'000;
  constexpr unsigned kBits = 12;
  if (keyed_.size() < kFew) {
    std::ranges::stable_sort(keyed_, {}, &Keyed::key);
    return;
  }
  const auto [low, high] = std::ranges::minmax(keyed_, {}, &Keyed::key);
  const auto least = low.key;
  const auto most = static_cast<std::uint32_t>(high.key - least);
  for (unsigned shift = 0; shift < 32 && most >> shift != 0; shift += kBits) {
    const auto digit = [&](const Keyed& k) { return static_cast<std::uint32_t>(k.key - least) >> shift & 0xFFFu; };
    std::array<std::size_t, (1u << kBits) + 1> first{};
    for (const Keyed& k : keyed_) ++first[digit(k) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    sorted_.resize(keyed_.size());
    for (const Keyed& k : keyed_) sorted_[first[digit(k)]++] = k;
    keyed_.swap(sorted_);
  }
}

/// Returns the smaller of two boxes: one side along the beams' first and last, or horizontal.
DirectionBox Grouping::box_of(Range range) const {
  const glm::dvec3 axis = mean(range), level = level_side(axis);
  const auto beam = [&](std::size_t i) { return directions_[order_[range.first + i]]; };
  const std::size_t count = range.second - range.first;
  DirectionBox best;
  for (const glm::dvec3& side : {side_along(axis, beam(0), beam(count - 1), level), level}) {
    const DirectionBox box = box_along(side, axis, count, beam);
    if (box.area < best.area) best = box;
  }
  add_planes(best);
  return best;
}

template <std::uint32_t count>
void write_box(const DirectionBox& box, DirectionBoxes<count>& out, std::uint32_t i) {
  const auto put = [i](glm::dvec3 v, float(*to)[count]) {
    for (int axis = 0; axis < 3; ++axis) to[axis][i] = static_cast<float>(v[axis]);
  };
  put(box.c, out.box), put(box.U, out.box + 3), put(box.V, out.box + 6);
  for (int k = 0; k < 4; ++k) put(box.plane[k], out.plane + 3 * k);
  put(box.axis, out.axis);
}

void Grouping::write_tile(std::span<const Range> vectors, BeamTile& tile) const {
  const DirectionBox all = box_of({vectors.front().first, vectors.back().second});
  write_box(all, tile.tile, 0);
  tile.longest = static_cast<float>(all.longest * 1.000001);
  std::uint32_t run = kWidth;
  tile.used = static_cast<std::uint32_t>(vectors.size());
  for (std::uint32_t v = 0; v < kTileVectors; ++v) {
    const Range range = vectors[std::min<std::size_t>(v, vectors.size() - 1)];
    const DirectionBox box = box_of(range);
    write_box(box, tile.vectors, v);
    tile.longest = std::max(tile.longest, static_cast<float>(box.longest * 1.000001));
    if (range.second - range.first < kWidth) run = 1;
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      const std::uint32_t at = kWidth * v + i, beam = order_[std::min(range.first + i, range.second - 1)];
      write_beam(directions_[beam], beam, at, tile);
      if (i > 0 && beam != tile.place[at - 1] + 1) run = i % 4 == 0 ? std::min(run, 4u) : 1;
    }
  }
  tile.run = run;
}

/// Sorts the beams by time. @return ranges with one time each
std::vector<Grouping::Range> Grouping::equal_times(std::span<const double> times) {
  if (times.empty()) return {{0, order_.size()}};
  std::ranges::stable_sort(order_, {}, [&](std::uint32_t i) { return times[i]; });
  std::vector<Range> ranges;
  for (std::size_t i = 0; i < order_.size(); ++i) {
    if (i == 0 || times[order_[i]] != times[order_[i - 1]]) ranges.push_back({i, i});
    ++ranges.back().second;
  }
  return ranges;
}

void Grouping::write_tiles(std::span<const Range> vectors, double time, BeamPattern& pattern) {
  for (const Range& vector : vectors) std::sort(order_.begin() + vector.first, order_.begin() + vector.second);
  for (std::size_t first = 0; first < vectors.size(); first += kTileVectors) {
    const std::size_t count = std::min<std::size_t>(kTileVectors, vectors.size() - first);
    write_tile(vectors.subspan(first, count), pattern.emplace_back());
    pattern.back().time = time;
  }
}

BeamPattern Grouping::make(std::span<const double> times) {
  BeamPattern pattern;
  const double weight = tile_weight();
  for (const Range& range : equal_times(times)) {
    std::vector<Range> groups;
    split(range, kTileBeams, weight, groups);
    for (const Range& group : groups) {
      std::vector<Range> vectors;
      split(group, kWidth, along_row() && times.empty() ? 16.0 : 1.0, vectors);
      write_tiles(vectors, times.empty() ? 0.0 : times[order_[range.first]], pattern);
    }
  }
  return pattern;
}

/// Lists pixels in strips of 16 rows, to the right and back, each in stripes of four columns, down and up.
BeamPattern Grouping::make_image(std::uint32_t width) {
  constexpr std::uint32_t kRows = 16, kColumns = 4;
  const auto height = static_cast<std::uint32_t>(directions_.size() / width);
  const std::uint32_t stripes = (width + kColumns - 1) / kColumns;
  order_.clear();
  for (std::uint32_t top = 0, strip = 0; top < height; top += kRows, ++strip)
    for (std::uint32_t k = 0; k < stripes; ++k) {
      const std::uint32_t left = kColumns * (strip % 2 == 0 ? k : stripes - 1 - k),
                          rows = std::min(kRows, height - top);
      for (std::uint32_t r = 0; r < rows; ++r)
        for (std::uint32_t u = left; u < std::min(width, left + kColumns); ++u)
          order_.push_back(width * (top + (k % 2 == 0 ? r : rows - 1 - r)) + u);
    }
  std::vector<Range> vectors;
  for (std::size_t first = 0; first < order_.size(); first += kWidth)
    vectors.push_back({first, std::min(order_.size(), first + kWidth)});
  for (std::size_t first = 0; first < order_.size(); first += kTileBeams)
    if (!narrow({first, std::min(order_.size(), first + kTileBeams)}, kLeastCosine)) return make({});
  BeamPattern pattern;
  write_tiles(vectors, 0.0, pattern);
  return pattern;
}

/// Returns a box around directions in their order.
DirectionBox box_of(std::span<const glm::dvec3> directions) {
  glm::dvec3 sum{};
  for (const glm::dvec3& d : directions) sum += d;
  const glm::dvec3 axis = glm::normalize(sum),
                   side = side_along(axis, directions.front(), directions.back(), level_side(axis));
  DirectionBox box = box_along(side, axis, directions.size(), [&](std::size_t i) { return directions[i]; });
  add_planes(box);
  return box;
}

}  // namespace

void fill_tile(std::span<const glm::dvec3> directions, double time, BeamTile& tile) {
  const auto count = static_cast<std::uint32_t>(directions.size());
  tile.used = (count + kWidth - 1) / kWidth, tile.run = kWidth, tile.time = time;
  std::array<glm::dvec3, 4 * kTileVectors> corners;
  double longest = 0.0;
  for (std::uint32_t v = 0; v < tile.used; ++v) {
    const DirectionBox box = box_of(directions.subspan(kWidth * v, std::min(kWidth, count - kWidth * v)));
    write_box(box, tile.vectors, v);
    longest = std::max(longest, box.longest);
    for (std::uint32_t k = 0; k < 4; ++k)
      corners[4 * v + k] = box.c + (k < 2 ? box.U : -box.U) + (k % 2 == 0 ? box.V : -box.V);
  }
  const DirectionBox all = box_of(std::span(corners).first(4 * tile.used));
  write_box(all, tile.tile, 0);
  tile.longest = static_cast<float>(std::max(longest, all.longest) * 1.000001);
  for (std::uint32_t i = 0; i < kWidth * tile.used; ++i) write_beam(directions[std::min(i, count - 1)], i, i, tile);
}

BeamPattern make_pattern(std::span<const glm::dvec3> directions, std::uint32_t row, std::span<const double> times) {
  return Grouping(directions, row).make(times);
}

BeamPattern make_image_pattern(std::span<const glm::dvec3> directions, std::uint32_t width) {
  return Grouping(directions, 0).make_image(width);
}

}  // namespace sf::scene
