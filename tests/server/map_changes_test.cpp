#include "server/map_changes.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <limits>

namespace sf::server {
namespace {

constexpr maps::GridGeometry kChangesArea{.left = -1.8, .top = 1.8, .word_columns = 5, .word_rows = 3};  ///< 20 x 12

control::MapChanges any_changes() {
  control::MapChanges changes;
  for (int i = *rc::gen::inRange(0, 40); i > 0; --i)
    changes.cells.push_back({{*rc::gen::inRange(0, 20), *rc::gen::inRange(0, 12)},
                             *rc::gen::element(maps::Cell::free, maps::Cell::occupied)});
  for (int i = *rc::gen::inRange(0, 40); i > 0; --i)
    changes.points.emplace_back(1e-7 * *rc::gen::inRange(-1'000'000, 1'000'000), std::pow(0.7, i));
  for (int i = *rc::gen::inRange(0, 40); i > 0; --i) changes.nodes.push_back(*rc::gen::inRange(0, 9 * 240));
  return changes;
}

bool equal(const control::MapChanges& a, const control::MapChanges& b) {
  const auto same = [](const auto& x, const auto& y) { return x.at == y.at && x.state == y.state; };
  return std::ranges::equal(a.cells, b.cells, same) && a.points == b.points && a.nodes == b.nodes;
}

base::Bytes bytes_of(const control::MapChanges& changes) {
  base::Bytes bytes;
  encode_changes(changes, kChangesArea, bytes);
  return bytes;
}

TEST(MapChanges, RoundTrip) {
  EXPECT_TRUE(rc::check([] {
    const control::MapChanges changes = any_changes();
    const auto again = decode_changes(bytes_of(changes), kChangesArea);
    RC_ASSERT(again && equal(*again, changes));
  }));
}

/// Any prefix and any changed byte: the result is in the map, or nothing.
TEST(MapChanges, OtherBytesAreRefusedOrInTheMap) {
  EXPECT_TRUE(rc::check([] {
    base::Bytes bytes = bytes_of(any_changes());
    const auto at = static_cast<std::size_t>(*rc::gen::inRange(0, static_cast<int>(bytes.size())));
    RC_ASSERT(!decode_changes(std::span(bytes).first(at), kChangesArea));
    bytes[at] = *rc::gen::arbitrary<std::uint8_t>();
    const auto changes = decode_changes(bytes, kChangesArea);
    for (std::size_t i = 0; changes && i < changes->cells.size(); ++i)
      RC_ASSERT(maps::contains(kChangesArea, changes->cells[i].at));
    for (std::size_t i = 0; changes && i < changes->nodes.size(); ++i)
      RC_ASSERT(changes->nodes[i] >= 0 && changes->nodes[i] < 9 * 240);
  }));
}

/// The example of docs/packets.md, its neighbours at the limits, and each list with too many or too few bytes.
TEST(MapChanges, Limits) {
  const auto decoded = [](const base::Bytes& bytes) { return decode_changes(bytes, kChangesArea).has_value(); };
  EXPECT_TRUE(decoded({1, 0xbc, 7, 0, 0})) << "cell 239, the last";
  EXPECT_FALSE(decoded({1, 0xc0, 7, 0, 0})) << "cell 240";
  EXPECT_FALSE(decoded({1, 2, 0, 0})) << "cell -1";
  EXPECT_TRUE(decoded({0, 0, 1, 0xde, 0x21})) << "node 2159, the last";
  EXPECT_FALSE(decoded({0, 0, 1, 0xe0, 0x21}));
  EXPECT_FALSE(decoded({0, 0, 1, 1})) << "node -1";
  EXPECT_FALSE(decoded({0, 0, 0, 0})) << "a byte more";
  EXPECT_FALSE(decoded({0, 0}));
  EXPECT_FALSE(decoded({0xff, 0xff, 0xff, 0xff, 0x7f, 0, 0})) << "more cells than bytes: nothing is allocated";
  EXPECT_FALSE(decoded({0, 0xff, 0xff, 0xff, 0xff, 0x7f, 0}));
  EXPECT_FALSE(decoded({0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0, 0, 0})) << "a number of 57 bits";
  for (const double bad : {1.1e7, -1.1e7, HUGE_VAL, std::numeric_limits<double>::quiet_NaN()})
    for (const glm::dvec2& p : {glm::dvec2{bad, 0.0}, glm::dvec2{0.0, bad}})
      EXPECT_FALSE(decoded(bytes_of({.cells = {}, .points = {p}, .nodes = {}}))) << bad;
  EXPECT_TRUE(decoded(bytes_of({.cells = {}, .points = {{1e7, -1e7}}, .nodes = {}})));
}

TEST(MapChanges, TheDocumentedExampleIsOneFreeCell) {
  const auto changes = decode_changes(base::Bytes{0x01, 0xb4, 0x74, 0x00, 0x00}, {.left = -1.8, .top = 1.8});
  ASSERT_TRUE(changes && changes->cells.size() == 1 && changes->points.empty() && changes->nodes.empty());
  EXPECT_EQ(changes->cells[0].at, (maps::CellAt{3725 % 120, 3725 / 120}));
  EXPECT_EQ(changes->cells[0].state, maps::Cell::free);
}

}  // namespace
}  // namespace sf::server
