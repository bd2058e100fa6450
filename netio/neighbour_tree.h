#pragma once
// The robots nearest to a place, from a k-d tree of points that is built each tick.
//
//   tree.build(places);
//   for (const std::uint32_t row : tree.find({.p = p, .own = row, .range = 50.0, .max_count = 64})) ...

#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "base/pose.h"

namespace sf::netio {

/// One thread. Nothing is allocated after construction.
class NeighbourTree {
 public:
  /// Places looked at for one query at most: a crowd at one place, or on a circle, costs no more than another.
  static constexpr std::size_t kMaxVisits = 512;

  struct Place {
    glm::dvec2 p;           ///< [m]
    std::uint32_t row = 0;  ///< whose
    std::uint32_t age = 0;  ///< [passes] since it was said
  };
  struct Query {
    std::optional<glm::dvec2> p;  ///< [m]; nothing: anywhere
    std::uint32_t own = 0;        ///< row that is left out
    double range = 0.0;           ///< [m] >= 0, its end included
    std::size_t max_count = 0;    ///< rows, in [1, kMaxVisits]
    std::uint32_t max_age = 0;    ///< [passes]
  };

  /// @param capacity places at most
  explicit NeighbourTree(std::size_t capacity);

  /// All places of a tick, each row once.
  void build(std::span<const Place> places);

  /// Rows of the places nearest to `p`, the nearest first: exactly these unless kMaxVisits were looked at before.
  /// Without `p`, of any places, others each time. Lives until the next call.
  std::span<const std::uint32_t> find(const Query& query);

  /// Places that were looked at since construction.
  std::uint64_t visits() const { return visits_; }

 private:
  struct Found {
    double square;  ///< [m^2] of its distance
    std::uint32_t row;
    bool operator<(const Found& other) const { return std::tie(square, row) < std::tie(other.square, other.row); }
  };
  void split(std::size_t first, std::size_t last);
  void search(std::size_t first, std::size_t last);
  void visit(const Place& place);
  void find_any();
  bool is_near(double square) const;

  std::vector<Place> places_;       ///< a tree: the middle one of each range parts the others
  std::vector<std::uint8_t> by_y_;  ///< per place: it parts by y; else by x
  Query query_;
  std::size_t visits_left_ = 0;  ///< looks of this query
  std::vector<Found> found_;     ///< a heap, the farthest first
  std::vector<std::uint32_t> rows_;
  std::size_t next_ = 0;  ///< place that is next where any will do
  std::uint64_t visits_ = 0;
};

}  // namespace sf::netio
