#pragma once
// Placement of texts in a crowded figure: next to their marks, never overlapping each other, preferably over free
// space. All [px], y down.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "viz/canvas.h"

namespace sf::viz {

struct LabelBox {
  glm::dvec2 low;   ///< upper left corner
  glm::dvec2 high;  ///< lower right corner
};

/// Limits of a label's distance from its mark.
struct LabelRules {
  double nearest = 4.0;    ///< between the mark and the box
  double farthest = 60.0;  ///< between the mark and the box; beyond `leader`, a thin line connects label and mark
  double leader = 14.0;
  double clear_cost = 1.0;  ///< weight of free space relative to distance; 0 ignores free space
};

class Labels {
 public:
  /// @param plot labels stay inside it
  explicit Labels(const PixelBox& plot);

  /// Marks an area that labels should avoid if possible: a line of `width`, or the inside of a closed outline.
  void avoid(std::span<const glm::dvec2> line, double width);
  /// A box that no label may cover.
  void forbid(const LabelBox& box);

  /// True if the box is inside the plot and covers neither a drawing nor a label.
  bool is_bare(const LabelBox& box) const { return is_without(box, drawn | taken); }

  /// Finds the best position for `text` next to one of `marks` (the first of equally good ones), draws it and reserves
  /// its box. Returns false and draws nothing if there is no room.
  bool place(Canvas& canvas, std::span<const glm::dvec2> marks, const std::string& text, const TextStyle& style,
             const LabelRules& rules = {});

 private:
  enum Cell : std::uint8_t { bare = 0, drawn = 1, taken = 2 };
  /// The cells that a box touches: [i_min, i_max] x [j_min, j_max], inside the plot.
  struct Cells {
    int i_min = 0, i_max = 0, j_min = 0, j_max = 0;
  };
  Cells cells_of(const LabelBox& box) const;
  std::uint8_t& at(int i, int j) {
    return cells_[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i)];
  }
  std::uint8_t at(int i, int j) const {
    return cells_[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i)];
  }
  /// True if the box is inside the plot and none of its cells has any of `bits` set.
  bool is_without(const LabelBox& box, int bits) const;
  double covered(const LabelBox& box) const;
  void mark(const LabelBox& box, Cell as);

  PixelBox plot_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint8_t> cells_;  ///< of 4 x 4 pixels each: bits of Cell
};

}  // namespace sf::viz
