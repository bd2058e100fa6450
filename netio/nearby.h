#pragma once
// Whose states a robot is passed: those of the nearest others within the radio's range, found without a look at all.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/pose.h"

namespace sf::netio {

/// One thread. Nothing is allocated after the first use at full size.
class Nearby {
 public:
  /// Looks at no more than this many for one asker, so that a crowd at one place costs what a crowd elsewhere does.
  static constexpr std::size_t kMostLooks = 512;

  struct Place {
    base::Vec2 p;           ///< [m]
    std::uint32_t row = 0;  ///< whose
  };

  explicit Nearby(std::size_t capacity);

  /// Takes all places of a tick.
  void build(std::span<const Place> places);

  /// Rows of at most `most` of those nearest to `p`, within `range` [m]: exactly the nearest, unless more than
  /// kMostLooks lie as near along x. Without a place any will do, other ones each time. Never `own`; in order of rows.
  /// The span lives until the next call.
  std::span<const std::uint32_t> find(const std::optional<base::Vec2>& p, std::uint32_t own, double range,
                                      std::size_t most);

 private:
  struct Found {
    double square;  ///< [m^2]
    std::uint32_t row;
  };
  void look(const Place& place, base::Vec2 p, double square, std::size_t most);

  std::vector<Place> places_;  ///< by x, then by row
  std::vector<Found> found_;   ///< a heap, the farthest first
  std::vector<std::uint32_t> rows_;
  std::size_t turn_ = 0;
};

}  // namespace sf::netio
