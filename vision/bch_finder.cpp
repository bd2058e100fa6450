#include "vision/bch_finder.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <optional>

#include "base/pose.h"
#include "vision/bch_code.h"
#include "vision/median.h"
#include "vision/tag_fit.h"

namespace sf::vision {

namespace {

constexpr double kMinCellContrast = 12;  // [grey] between the border and the white cells

/// The perspective map from the unit square to a quadrilateral (P. Heckbert, "Fundamentals of Texture Mapping and Image
/// Warping", 1989).
struct QuadMap {
  glm::dvec2 a, b, c;
  double g = 0.0, h = 0.0;

  /// @param p not on one line
  explicit QuadMap(const std::array<glm::dvec2, 4>& p) : c(p[0]) {
    const glm::dvec2 sum = p[0] - p[1] + p[2] - p[3], d1 = p[1] - p[2], d2 = p[3] - p[2];
    const double det = base::cross(d1, d2);
    g = base::cross(sum, d2) / det;
    h = base::cross(d1, sum) / det;
    a = p[1] - p[0] + g * p[1];
    b = p[3] - p[0] + h * p[3];
  }
  glm::dvec2 at(double u, double v) const { return (u * a + v * b + c) / (g * u + h * v + 1.0); }
};

/// Returns the mean grey values of n x n cells, row by row.
std::vector<double> cells_of(const Image& image, const QuadMap& map, int n) {
  std::vector<double> cells;
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column) {
      double sum = 0.0;
      for (const double dv : {0.35, 0.65})
        for (const double du : {0.35, 0.65}) sum += grey_at(image, map.at((column + du) / n, (row + dv) / n));
      cells.push_back(0.25 * sum);
    }
  return cells;
}

/// Reads the code of a square with a black border of `border` cells; nullopt if it has none.
std::optional<BchMatch> read_code(const Image& image, const QuadMap& map, int border) {
  const int n = kBchCells + 2 * border;
  const std::vector<double> cells = cells_of(image, map, n);
  std::vector<double> around, inside;
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column) {
      const bool is_code = std::min(row, column) >= border && std::max(row, column) < n - border;
      (is_code ? inside : around).push_back(cells[static_cast<std::size_t>(n * row + column)]);
    }
  std::vector<double> sorted = inside;
  std::nth_element(sorted.begin(), sorted.begin() + 3, sorted.end(), std::greater<>());  // 4 cells may be too bright
  const double white = sorted[3], black = median(around);
  const double level = 0.5 * (black + white);
  const auto wrong = std::count_if(around.begin(), around.end(), [level](double grey) { return grey > level; });
  // A quarter of a thin border may be hidden, and an eighth of a wide one, which otherwise could include white.
  const std::ptrdiff_t share = border == 1 ? 4 : 8;
  if (white - black < kMinCellContrast || share * wrong > static_cast<std::ptrdiff_t>(around.size()))
    return std::nullopt;
  BchWord word = 0;
  for (const double grey : inside) word = word << 1 | (grey > level ? 1u : 0u);
  return decode_bch(word);
}

class BchFinder : public TagFinder {
 public:
  bool find(const Image& image, const Region& region, std::vector<TagOutline>& found) override {
    found.clear();
    read_.clear();
    if (!squares_->find(image, region, outlines_)) return false;
    for (const TagOutline& square : outlines_) {
      const auto& c = square.corners;
      if (!(std::abs(base::cross(c[1] - c[2], c[3] - c[2])) > 1.0)) continue;
      const QuadMap map(c);
      auto match = read_code(image, map, 1);
      const auto standard = read_code(image, map, 3);
      if (standard && (!match || standard->errors < match->errors)) match = standard;
      if (!match) continue;
      TagOutline outline{match->id, square.corners};
      std::rotate(outline.corners.begin(), outline.corners.begin() + match->turns, outline.corners.end());
      read_.push_back({outline, match->errors, glm::distance(outline.corners[0], outline.corners[2])});
    }
    keep_best(found);
    return true;
  }

 private:
  struct Read {
    TagOutline outline;
    int errors = 0;
    double diagonal = 0.0;  ///< [px]
  };
  static glm::dvec2 middle(const TagOutline& o) { return 0.5 * (o.corners[0] + o.corners[2]); }

  /// A marker is also found by the inner edge of a wide border, and by the outer edge of the white around it: of
  /// squares around one centre, keeps the one with the fewest errors, or else the largest.
  void keep_best(std::vector<TagOutline>& found) {
    std::sort(read_.begin(), read_.end(), [](const Read& a, const Read& b) {
      return a.errors != b.errors ? a.errors < b.errors : a.diagonal > b.diagonal;
    });
    for (const Read& each : read_) {
      const auto is_same = [&](const TagOutline& o) {
        return o.id == each.outline.id && glm::distance(middle(o), middle(each.outline)) < 0.25 * each.diagonal;
      };
      if (std::none_of(found.begin(), found.end(), is_same)) found.push_back(each.outline);
    }
  }

  std::vector<Read> read_;
  std::unique_ptr<TagFinder> squares_ = opencv().make_tag_finder("");
  std::vector<TagOutline> outlines_;
};

}  // namespace

TagPattern bch_pattern(std::uint32_t id) {
  constexpr int kCells = kBchCells + 2;
  TagPattern pattern{kCells, std::vector<std::uint8_t>(kCells * kCells, 0)};
  BchWord word = encode_bch(id);
  for (int row = kBchCells; row > 0; --row)
    for (int column = kBchCells; column > 0; --column, word >>= 1)
      pattern.white[static_cast<std::size_t>(kCells * row + column)] = word & 1;
  return pattern;
}

std::unique_ptr<TagFinder> make_bch_finder() { return std::make_unique<BchFinder>(); }

}  // namespace sf::vision
