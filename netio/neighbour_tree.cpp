#include "netio/neighbour_tree.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace sf::netio {

namespace {

double along(glm::dvec2 p, std::uint8_t by_y) { return by_y ? p.y : p.x; }

/// Orders equal coordinates by row, so that a crowd at one place is split too and its robots find different neighbours.
bool before(glm::dvec2 p, std::uint32_t row, const NeighbourTree::Place& place, std::uint8_t by_y) {
  return std::tuple(along(p, by_y), row) < std::tuple(along(place.p, by_y), place.row);
}

/// Returns whether the extent along y is the larger one.
bool wider_along_y(std::span<const NeighbourTree::Place> places) {
  const auto width = [&](std::uint8_t by_y) {
    const auto [low, high] = std::minmax_element(places.begin(), places.end(), [&](const auto& a, const auto& b) {
      return along(a.p, by_y) < along(b.p, by_y);
    });
    return along(high->p, by_y) - along(low->p, by_y);
  };
  return width(1) > width(0);
}

}  // namespace

NeighbourTree::NeighbourTree(std::size_t capacity) {
  places_.reserve(capacity);
  by_y_.reserve(capacity);
  found_.reserve(kMaxVisits);
  rows_.reserve(kMaxVisits);
}

void NeighbourTree::build(std::span<const Place> places) {
  places_.assign(places.begin(), places.end());
  by_y_.assign(places.size(), 0);
  split(0, places_.size());
}

void NeighbourTree::split(std::size_t first, std::size_t last) {
  if (last - first < 2) return;
  const std::size_t middle = first + (last - first) / 2;
  const std::uint8_t by_y = wider_along_y(std::span(places_).subspan(first, last - first));
  const auto at = [&](std::size_t i) { return places_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(first), at(middle), at(last),
                   [&](const Place& a, const Place& b) { return before(a.p, a.row, b, by_y); });
  by_y_[middle] = by_y;
  split(first, middle);
  split(middle + 1, last);
}

std::span<const std::uint32_t> NeighbourTree::find(const Query& query) {
  SF_CHECK(query.max_count >= 1 && query.max_count <= kMaxVisits, std::to_string(query.max_count) + " neighbours");
  query_ = query;
  visits_left_ = kMaxVisits;
  found_.clear();
  rows_.clear();
  if (query.p) search(0, places_.size());
  if (!query.p) find_any();
  std::sort_heap(found_.begin(), found_.end());
  for (const Found& found : found_) rows_.push_back(found.row);
  return rows_;
}

/// Searches the side of `p` first, and the other side only if it may contain a nearer place.
void NeighbourTree::search(std::size_t first, std::size_t last) {
  if (first == last || visits_left_ == 0) return;
  const std::size_t middle = first + (last - first) / 2;
  const Place& place = places_[middle];
  visit(place);
  const std::uint8_t by_y = by_y_[middle];
  const bool below = before(*query_.p, query_.own, place, by_y);
  const double aside = along(place.p, by_y) - along(*query_.p, by_y);
  below ? search(first, middle) : search(middle + 1, last);
  if (!is_near(aside * aside)) return;
  below ? search(middle + 1, last) : search(first, middle);
}

bool NeighbourTree::is_near(double square) const {
  return square <= query_.range * query_.range && (found_.size() < query_.max_count || square < found_.front().square);
}

void NeighbourTree::visit(const Place& place) {
  --visits_left_;
  ++visits_;
  const glm::dvec2 d = query_.p ? place.p - *query_.p : glm::dvec2{};
  if (place.row == query_.own || place.age > query_.max_age || !is_near(dot(d, d))) return;
  if (found_.size() == query_.max_count) {
    std::pop_heap(found_.begin(), found_.end());
    found_.pop_back();
  }
  found_.push_back({dot(d, d), place.row});
  std::push_heap(found_.begin(), found_.end());
}

void NeighbourTree::find_any() {
  for (std::size_t k = 0; k < places_.size() && visits_left_ > 0 && found_.size() < query_.max_count; ++k, ++next_)
    visit(places_[next_ % places_.size()]);
}

}  // namespace sf::netio
