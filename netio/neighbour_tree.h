#pragma once
// Nearest-neighbour search among robots, with a k-d tree of points that is rebuilt each tick.
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

/// Single-threaded. Allocates nothing after construction.
class NeighbourTree {
 public:
  /// Maximum number of places visited per query. It bounds the cost for crowds at one place or on a circle.
  static constexpr std::size_t kMaxVisits = 512;

  struct Place {
    glm::dvec2 p;           ///< [m]
    std::uint32_t row = 0;  ///< row of the robot
    std::uint32_t age = 0;  ///< [passes] since its state was received
  };
  struct Query {
    std::optional<glm::dvec2> p;  ///< [m] centre; nullopt: no centre
    std::uint32_t own = 0;        ///< row to exclude
    double range = 0.0;           ///< [m] >= 0, inclusive
    std::size_t max_count = 0;    ///< maximum number of rows, in [1, kMaxVisits]
    std::uint32_t max_age = 0;    ///< [passes], inclusive
  };

  /// @param capacity maximum number of places
  explicit NeighbourTree(std::size_t capacity);

  /// Builds the tree of a tick. Each row occurs once.
  void build(std::span<const Place> places);

  /// Returns the rows of the places nearest to `p`, nearest first. The result is exact unless kMaxVisits is reached.
  /// Without `p` the rows are arbitrary and change from call to call. Valid until the next call.
  std::span<const std::uint32_t> find(const Query& query);

  /// Returns the number of places visited since construction.
  std::uint64_t visits() const { return visits_; }

 private:
  struct Found {
    double square;  ///< [m^2] distance squared
    std::uint32_t row;
    bool operator<(const Found& other) const { return std::tie(square, row) < std::tie(other.square, other.row); }
  };
  void split(std::size_t first, std::size_t last);
  void search(std::size_t first, std::size_t last);
  void visit(const Place& place);
  void find_any();
  bool is_near(double square) const;

  std::vector<Place> places_;       ///< a tree: the median of each range splits the other places
  std::vector<std::uint8_t> by_y_;  ///< per place: 1 splits by y, 0 by x
  Query query_;
  std::size_t visits_left_ = 0;  ///< visits left for this query
  std::vector<Found> found_;     ///< a heap; the farthest place is at the front
  std::vector<std::uint32_t> rows_;
  std::size_t next_ = 0;  ///< next place of queries without a centre
  std::uint64_t visits_ = 0;
};

}  // namespace sf::netio
