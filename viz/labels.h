#pragma once
// Where texts of a crowded figure may stand: beside what they name, never over each other, and rather not over what is
// drawn. All [px], y down.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "viz/canvas.h"

namespace sf::viz {

struct LabelBox {
  Vec2 low;   ///< upper left corner
  Vec2 high;  ///< lower right corner
};
inline bool overlap(const LabelBox& a, const LabelBox& b) {
  return a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y;
}

/// How far from its mark a label may be moved.
struct LabelRules {
  double nearest = 4.0;    ///< between the mark and the box
  double farthest = 60.0;  ///< likewise; beyond `leader` a thin line leads back to the mark
  double leader = 14.0;
  double clear_cost = 1.0;  ///< how much free ground counts against distance: 0 not at all
};

class Labels {
 public:
  /// @param plot labels stay inside of it
  explicit Labels(const PixelBox& plot);

  /// Ground that labels should rather not cover: a line of `width`, or the inside of a closed outline.
  void avoid(std::span<const Vec2> line, double width);
  /// A box that no label may cover.
  void forbid(const LabelBox& box) { taken_.push_back(box); }

  /// Finds a place for `text` beside one of `marks` (the first that does best), draws it and keeps others off it.
  /// False, and nothing drawn, where there is no room.
  bool place(Canvas& canvas, std::span<const Vec2> marks, const std::string& text, const TextStyle& style,
             const LabelRules& rules = {});

 private:
  bool is_free(const LabelBox& box) const;
  double covered(const LabelBox& box) const;
  void mark(Vec2 p, double radius);

  PixelBox plot_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint8_t> ground_;  ///< one cell of 4 x 4 pixels each: 1 where something is drawn
  std::vector<LabelBox> taken_;
};

}  // namespace sf::viz
