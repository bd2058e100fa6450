#include "sensors/lane_markings/marking_raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/box.h"
#include "base/error.h"
#include "sensors/lane_markings/outline.h"

namespace sf::sensors {

namespace {

/// The crossing of an edge and a row of cell centres: place and winding direction.
struct Crossing {
  double x;
  int turn;
  bool operator<(const Crossing& other) const { return x < other.x; }
};

/// Returns the smallest integer k with (k + 1/2) cell >= at.
std::int64_t first_centre(double at, double cell) { return static_cast<std::int64_t>(std::ceil(at / cell - 0.5)); }

/// Edges that an ascending row of cell centres may cross.
class Sweep {
 public:
  explicit Sweep(std::vector<OutlineEdge> faces) : faces_(std::move(faces)) {
    std::sort(faces_.begin(), faces_.end(), [](const OutlineEdge& p, const OutlineEdge& q) { return low(p) < low(q); });
  }
  /// Returns the crossings in order of x. `y` must not decrease between calls.
  const std::vector<Crossing>& cross(double y);

 private:
  static double low(const OutlineEdge& f) { return std::min(f.a.y, f.b.y); }

  std::vector<OutlineEdge> faces_;
  std::size_t next_ = 0;
  std::vector<OutlineEdge> active_;
  std::vector<Crossing> crossings_;
};

const std::vector<Crossing>& Sweep::cross(double y) {
  for (; next_ < faces_.size() && low(faces_[next_]) <= y; ++next_) active_.push_back(faces_[next_]);
  std::erase_if(active_, [y](const OutlineEdge& f) { return std::max(f.a.y, f.b.y) < y; });
  crossings_.clear();
  for (const OutlineEdge& f : active_) {
    const bool up = f.a.y <= y && f.b.y > y;
    const bool down = f.b.y <= y && f.a.y > y;
    if (up || down) crossings_.push_back({f.a.x + (y - f.a.y) / (f.b.y - f.a.y) * (f.b.x - f.a.x), up ? -1 : 1});
  }
  std::sort(crossings_.begin(), crossings_.end());
  return crossings_;
}

/// Returns true within one cell of an end edge, on its painted side.
bool near_end(const std::vector<OutlineEdge>& ends, glm::dvec2 p, double cell) {
  return std::any_of(ends.begin(), ends.end(), [&](const OutlineEdge& f) {
    const glm::dvec2 e = f.b - f.a;
    const double width = length(e);
    const double behind = base::cross(e, p - f.a) / width;
    const double beside = dot(e, p - f.a) / width;
    return behind >= 0.0 && behind <= cell && beside >= -cell && beside <= width + cell;
  });
}

}  // namespace

MarkingRaster::MarkingRaster(const std::vector<world::LaneMarking>& lane_markings, double cell, double margin,
                             const std::string& file, std::size_t most_bytes)
    : cell_(cell) {
  base::Box box = base::empty_box();
  double length_of_all = 0.0;
  for (const world::LaneMarking& s : lane_markings) {
    for (std::size_t i = 0; i < s.line.size(); ++i) {
      box = base::united(box, base::box_around(s.line[i], s.width));
      if (i > 0) length_of_all += length(s.line[i] - s.line[i - 1]) * (s.width / (kBlock * cell) + 2.0);
    }
  }
  const double block = kBlock * cell;
  const double across = (box.max.x - box.min.x + 2.0 * margin) / block + 3.0;
  const double down = (box.max.y - box.min.y + 2.0 * margin) / block + 3.0;
  const double bytes = 4.0 * across * down + 16.0 * length_of_all / block;
  if (!lane_markings.empty() && !(bytes <= static_cast<double>(most_bytes)))
    throw base::InputError(file, 0,
                           fmt::format("road_resolution {:g} m requires {:.0f} MiB for the pixels of this road; "
                                       "expected at most {}; use a coarser one, from {:.2g} m, or 0 for exact paint",
                                       cell, bytes / (1 << 20), most_bytes >> 20,
                                       cell * std::sqrt(bytes / static_cast<double>(most_bytes)) * 1.05));
  if (lane_markings.empty()) {
    directory_.assign(1, std::numeric_limits<std::uint32_t>::max() >> 1);
    return;
  }
  column_ = kBlock * (static_cast<std::int64_t>(std::floor((box.min.x - margin) / block)) - 1);
  row_ = kBlock * (static_cast<std::int64_t>(std::floor((box.min.y - margin) / block)) - 1);
  columns_ = static_cast<std::uint32_t>(across) + 1;
  rows_ = static_cast<std::uint32_t>(down) + 1;
  directory_.assign(std::size_t{columns_} * rows_, 0);
  for (const world::LaneMarking& s : lane_markings) paint(s);
  measure_distances();
}

bool MarkingRaster::bit(std::int64_t x, std::int64_t y, std::size_t plane) const {
  if (x < 0 || y < 0 || x / kBlock >= columns_ || y / kBlock >= rows_) return false;
  const std::uint32_t word = directory_[static_cast<std::size_t>(y / kBlock * columns_ + x / kBlock)];
  if ((word & kFull) == 0) return false;
  const std::size_t at = 4 * std::size_t{word & ~kFull} + plane + static_cast<std::size_t>(y % kBlock / 4);
  return (blocks_[at] >> (y % 4 * kBlock + x % kBlock)) & 1u;
}

void MarkingRaster::set(std::int64_t x, std::int64_t y, std::size_t plane) {
  std::uint32_t& word = directory_[static_cast<std::size_t>(y / kBlock * columns_ + x / kBlock)];
  if (word == 0) {
    word = kFull | static_cast<std::uint32_t>(blocks_.size() / 4);
    blocks_.resize(blocks_.size() + 4);
  }
  const std::size_t at = 4 * std::size_t{word & ~kFull} + plane + static_cast<std::size_t>(y % kBlock / 4);
  blocks_[at] |= 1u << (y % 4 * kBlock + x % kBlock);
}

void MarkingRaster::paint(const world::LaneMarking& marking) {
  std::vector<OutlineEdge> faces;
  add_outline(marking, faces);
  // Relative to the raster, for equal precision far from the origin.
  const glm::dvec2 corner{static_cast<double>(column_) * cell_, static_cast<double>(row_) * cell_};
  base::Box box = base::empty_box();
  for (OutlineEdge& f : faces) {
    f.a = f.a - corner;
    f.b = f.b - corner;
    box = base::united(box, base::box_of(f.a, f.b));
  }
  std::vector<OutlineEdge> ends;
  std::copy_if(faces.begin(), faces.end(), std::back_inserter(ends), [](const OutlineEdge& f) { return f.is_end; });
  Sweep sweep(std::move(faces));
  for (std::int64_t y = first_centre(box.min.y, cell_); (static_cast<double>(y) + 0.5) * cell_ <= box.max.y; ++y) {
    const double centre = (static_cast<double>(y) + 0.5) * cell_;
    const std::vector<Crossing>& crossings = sweep.cross(centre);
    int inside = 0;
    for (std::size_t k = 0; k + 1 < crossings.size(); ++k) {
      inside += crossings[k].turn;
      if (inside == 0) continue;
      const std::int64_t end = first_centre(crossings[k + 1].x, cell_);
      for (std::int64_t x = first_centre(crossings[k].x, cell_); x < end; ++x) {
        set(x, y, 0);
        if (near_end(ends, {(static_cast<double>(x) + 0.5) * cell_, centre}, cell_)) set(x, y, 2);
      }
    }
  }
}

/// Makes two passes, each over the neighbours already visited. This is exact for the chessboard distance (A. Rosenfeld,
/// J. Pfaltz, "Distance functions on digital pictures", Pattern Recognition 1 (1968)).
void MarkingRaster::measure_distances() {
  const auto far = std::numeric_limits<std::uint32_t>::max() >> 1;
  const auto w = static_cast<std::int64_t>(columns_);
  const auto h = static_cast<std::int64_t>(rows_);
  for (std::uint32_t& word : directory_)
    if (word == 0) word = far;
  const auto at = [&](std::int64_t x, std::int64_t y) -> std::uint32_t& {
    return directory_[static_cast<std::size_t>(y * w + x)];
  };
  const auto distance = [&](std::int64_t x, std::int64_t y) {
    if (x < 0 || y < 0 || x >= w || y >= h) return far;
    return (at(x, y) & kFull) != 0 ? 0u : at(x, y);
  };
  const auto take = [&](std::int64_t x, std::int64_t y, int way) {
    std::uint32_t& word = at(x, y);
    if ((word & kFull) != 0) return;
    const std::uint32_t near =
        std::min({distance(x - way, y), distance(x - 1, y - way), distance(x, y - way), distance(x + 1, y - way)});
    word = std::min(word, near + 1);
  };
  for (std::int64_t y = 0; y < h; ++y)
    for (std::int64_t x = 0; x < w; ++x) take(x, y, 1);
  for (std::int64_t y = h; y-- > 0;)
    for (std::int64_t x = w; x-- > 0;) take(x, y, -1);
}

}  // namespace sf::sensors
