// Compares boxes and their tree with a brute-force test of every box.

#include "base/box_tree.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/sensors/chance.h"

namespace sf::base {
namespace {

using Rows = std::multiset<std::uint32_t>;

TEST(Box, AcceptsCornersInAnyOrder) {
  const Box box = box_of({3, -2}, {-1, 5});
  EXPECT_EQ(std::pair(box.min.x, box.min.y), std::pair(-1.0, -2.0));
  EXPECT_EQ(std::pair(box.max.x, box.max.y), std::pair(3.0, 5.0));
}

TEST(Box, TouchingBoxesMeet) {
  const Box box = box_around({0, 0}, 1.0);
  EXPECT_TRUE(meet(box, box_around({2, 2}, 1.0))) << "a corner";
  EXPECT_TRUE(meet(box, {{0.5, -5}, {0.5, 5}})) << "a line across it";
  EXPECT_FALSE(meet(box, box_around({0, 2.1}, 1.0)));
  EXPECT_FALSE(meet(box, empty_box()));
}

/// Boxes of all sizes, some of them equal. Every third box is a line or a point.
std::vector<Box> random_boxes(std::uint32_t count, glm::dvec2 around, trial::Chance& chance) {
  std::vector<Box> boxes;
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::dvec2 p = around + chance.in_square(20.0);
    const double wide = i % 3 == 0 ? 0.0 : std::pow(10.0, chance.between(-3, i % 50 == 1 ? 5 : 1));
    boxes.push_back(i % 7 == 6 ? boxes.back() : box_of(p, p + glm::dvec2{wide, i % 2 == 0 ? 0.0 : 0.3 * wide}));
  }
  return boxes;
}

Rows found(const BoxTree& tree, const Box& box) {
  Rows rows;
  tree.any(box, [&](std::uint32_t i) {
    rows.insert(i);
    return false;
  });
  return rows;
}

Rows expected(const std::vector<Box>& boxes, const Box& box) {
  Rows rows;
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    if (meet(boxes[i], box)) rows.insert(i);
  return rows;
}

TEST(BoxTree, MatchesBruteForce) {
  trial::Chance chance(1);
  for (const std::uint32_t count : {0u, 1u, 2u, 7u, 8u, 9u, 500u})
    for (const glm::dvec2& around : {glm::dvec2{}, glm::dvec2{1e5, -1e5}}) {
      const std::vector<Box> boxes = random_boxes(count, around, chance);
      const BoxTree single(boxes), grouped(boxes, 8);
      for (int i = 0; i < 100; ++i) {
        const Box box = box_around(around + chance.in_square(25.0), std::pow(10.0, chance.between(-3, 2)));
        const Rows rows = expected(boxes, box), near = found(grouped, box);
        EXPECT_EQ(found(single, box), rows);
        EXPECT_TRUE(std::includes(near.begin(), near.end(), rows.begin(), rows.end()));
        EXPECT_EQ(std::set(near.begin(), near.end()).size(), near.size()) << "each once";
      }
    }
}

TEST(BoxTree, VisitsFewOtherBoxes) {
  trial::Chance chance(2);
  std::vector<Box> boxes;
  for (int i = 0; i < 20'000; ++i) boxes.push_back(box_around(chance.in_square(100.0), 0.1));
  const BoxTree tree(boxes, 8);
  std::size_t count = 0, wanted = 0;
  for (int i = 0; i < 100; ++i) {
    const Box box = box_around(chance.in_square(90.0), 5.0);
    count += found(tree, box).size();
    wanted += expected(boxes, box).size();
  }
  EXPECT_LT(count, 2 * wanted);
}

TEST(BoxTree, StopsAtTheFirstMatch) {
  trial::Chance chance(3);
  const BoxTree tree(random_boxes(100, {}, chance));
  int asked = 0;
  EXPECT_TRUE(tree.any(box_around({}, 100), [&](std::uint32_t) { return ++asked == 3; }));
  EXPECT_EQ(asked, 3);
}

/// Sums over subtrees rely on this order.
TEST(BoxTree, NodesAreDepthFirst) {
  trial::Chance chance(4);
  const std::vector<Box> boxes = random_boxes(100, {}, chance);
  const BoxTree tree(boxes);
  ASSERT_EQ(tree.nodes().size(), 199u);
  EXPECT_EQ(tree.nodes()[0].end, 199u);
  for (std::size_t i = 0; i < tree.nodes().size(); ++i) {
    const BoxTree::Node& node = tree.nodes()[i];
    if (node.count == 0) {
      EXPECT_EQ(tree.nodes()[tree.nodes()[i + 1].end].end, node.end) << "the second child ends with its parent";
      continue;
    }
    EXPECT_EQ(node.end, i + 1);
    EXPECT_EQ(node.box.min.x, boxes[tree.order()[node.first]].min.x);
  }
}

}  // namespace
}  // namespace sf::base
