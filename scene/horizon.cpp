#include "scene/horizon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sf::scene {

namespace {

constexpr double kInnermost = 4.0;  ///< [cells] radius of the innermost disc; each ring around it is wider by sqrt(2)

/// A block of cells, relative to the sensor.
struct Block {
  glm::dvec2 low, high;  ///< [m] its corners
  double top = 0.0;      ///< [m] bound of its height
  double nearest() const { return glm::length(glm::clamp(glm::dvec2(0.0), low, high)); }
  double farthest() const { return glm::length(glm::max(glm::abs(low), glm::abs(high))); }
};

class Building {
 public:
  Building(const FieldView& view, Horizon& out) : v_(view), f_(*view.field), out_(out) {}
  void run();

 private:
  void set_rings();
  void add_annulus(double from, double to, std::int32_t level);
  void add(const Block& block, double from);
  Block block_at(std::int32_t x, std::int32_t y, std::int32_t level) const;
  glm::dvec2 metres(glm::ivec2 point) const { return (glm::dvec2(point - v_.base) - v_.from) * f_.cell; }

  const FieldView& v_;
  const HeightField& f_;
  Horizon& out_;
};

void Building::set_rings() {
  const double cell = std::max(f_.cell.x, f_.cell.y);
  const glm::dvec2 far = glm::max(glm::abs(metres({0, 0})), glm::abs(metres({f_.columns - 1, f_.rows - 1})));
  const double last = std::min(v_.range_max, glm::length(far)) * 1.000001;
  out_.rings = 0;
  double reach = kInnermost * cell;
  for (std::int32_t k = 0; k < Horizon::kMostRings; ++k, reach *= M_SQRT2) {
    const bool whole = reach >= last || k + 1 == Horizon::kMostRings;
    out_.reach[k] = static_cast<float>(whole ? last : reach);
    out_.level[k] = std::clamp(k / 2, 1, f_.levels);
    out_.rings = k + 1;
    if (whole) break;
  }
  for (auto& sector : out_.slope) std::fill_n(sector, Horizon::kMostRings, -HUGE_VALF);
}

Block Building::block_at(std::int32_t x, std::int32_t y, std::int32_t level) const {
  const glm::ivec2 low{x << level, y << level};
  const glm::ivec2 high = glm::min(low + (1 << level), {f_.columns - 1, f_.rows - 1});
  const std::int32_t row = y - (f_.bias >> level) + f_.bias / 2;
  const BoundingPlane& plane =
      f_.above[static_cast<std::size_t>(row) * static_cast<std::size_t>(f_.pitch) + static_cast<std::size_t>(x)];
  const glm::dvec2 size(high - low);
  const double rise = std::max(0.0, plane.slope[0] * size.x) + std::max(0.0, plane.slope[1] * size.y);
  return {metres(low), metres(high), plane.height + rise * double{f_.slope_unit} - v_.z};
}

void Building::add(const Block& block, double from) {
  const double near = block.nearest(), far = block.farthest();
  const double top = block.top + 2.0 * (v_.error32 + v_.error32_per_metre * far) + 1e-6 * std::abs(block.top);
  const double slope = top < 0.0 ? top / far : near > 0.0 ? top / near : HUGE_VAL;
  const auto rounded = std::nextafter(static_cast<float>(slope), HUGE_VALF);
  const std::int32_t ring = static_cast<std::int32_t>(
      std::upper_bound(out_.reach, out_.reach + out_.rings, std::max(near, from) * 0.999999) - out_.reach);
  if (ring >= out_.rings) return;
  double low = 0.0, high = Horizon::kSectors - 1.0;
  if (near > 0.0) {
    const glm::dvec2 middle = 0.5 * (block.low + block.high);
    const double centre = Horizon::sector_of(middle.x, middle.y);
    low = high = centre;
    for (const glm::dvec2& p :
         {block.low, block.high, glm::dvec2{block.low.x, block.high.y}, glm::dvec2{block.high.x, block.low.y}}) {
      const double turn = Horizon::sector_of(p.x, p.y) - centre, round = Horizon::kSectors;
      const double by = turn > 0.5 * round ? turn - round : turn < -0.5 * round ? turn + round : turn;
      low = std::min(low, centre + by - 1e-4), high = std::max(high, centre + by + 1e-4);
    }
  }
  for (auto s = static_cast<std::int32_t>(std::floor(low)); s <= static_cast<std::int32_t>(std::floor(high)); ++s) {
    float& most = out_.slope[(s + Horizon::kSectors) % Horizon::kSectors][ring];
    most = std::max(most, rounded);
  }
}

/// Adds the blocks between two circles around the sensor.
void Building::add_annulus(double from, double to, std::int32_t level) {
  const glm::dvec2 place = glm::dvec2(v_.base) + v_.from, reach = to / f_.cell;
  const glm::ivec2 last{f_.columns - 2, f_.rows - 2};
  const glm::ivec2 low = glm::clamp(glm::ivec2(glm::floor(place - reach)), glm::ivec2(0), last) >> level;
  const glm::ivec2 high = glm::clamp(glm::ivec2(glm::floor(place + reach)), glm::ivec2(0), last) >> level;
  for (std::int32_t y = low.y; y <= high.y; ++y)
    for (std::int32_t x = low.x; x <= high.x; ++x) {
      const Block block = block_at(x, y, level);
      if (block.farthest() >= from && block.nearest() <= to) add(block, from);
    }
}

void Building::run() {
  set_rings();
  const double last = out_.reach[out_.rings - 1];
  double from = 0.0, to = kInnermost * std::max(f_.cell.x, f_.cell.y);
  for (std::int32_t octave = 0; from < last; ++octave, from = to, to *= 2.0)
    add_annulus(from, std::min(to, last), std::clamp(octave - 1, 1, f_.levels));
  out_.highest = -HUGE_VALF;
  for (auto& sector : out_.slope) {
    for (std::int32_t k = 1; k < out_.rings; ++k) sector[k] = std::max(sector[k], sector[k - 1]);
    out_.highest = std::max(out_.highest, sector[out_.rings - 1]);
  }
}

}  // namespace

double Horizon::sector_of(double x, double y) {
  const double part = y / (std::abs(x) + std::abs(y));  // in [-1, 1]
  const double turn = x >= 0.0 ? part : 2.0 - part;     // in [-1, 3]
  return 0.25 * kSectors * (turn + 1.0);
}

void build_horizon(const FieldView& view, Horizon& out) { Building(view, out).run(); }

}  // namespace sf::scene
