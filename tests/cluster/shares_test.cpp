#include "cluster/shares.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <numeric>
#include <vector>

namespace sf::cluster {

namespace {

using Firsts = std::vector<std::uint32_t>;

TEST(Shares, SingleShareTakesAll) { EXPECT_EQ(equal_shares(std::vector<double>{1, 2, 3}, 1), (Firsts{0, 3})); }

TEST(Shares, DividesEqualItemsEvenly) { EXPECT_EQ(equal_shares(std::vector<double>(6, 1.0), 3), (Firsts{0, 2, 4, 6})); }

TEST(Shares, BalancesCostsNotItems) { EXPECT_EQ(equal_shares(std::vector<double>{3, 1, 1, 1}, 2), (Firsts{0, 1, 4})); }

TEST(Shares, MoreSharesThanItems) {  // some ranks have no robot
  const Firsts first = equal_shares(std::vector<double>{1, 1}, 5);
  EXPECT_EQ(first.front(), 0u);
  EXPECT_EQ(first.back(), 2u);
}

/// An item whose middle is exactly on the boundary of two shares belongs to the second one.
TEST(Shares, ItemOnABoundaryBelongsToTheLaterShare) {
  EXPECT_EQ(equal_shares(std::vector<double>{1, 1, 1}, 2), (Firsts{0, 1, 3}));
  EXPECT_EQ(equal_shares(std::vector<double>{2, 2, 2, 2, 2}, 2), (Firsts{0, 2, 5}));
  EXPECT_EQ(equal_shares(std::vector<double>{4}, 2), (Firsts{0, 0, 1}));
}

TEST(Shares, NoItems) { EXPECT_EQ(equal_shares({}, 2), (Firsts{0, 0, 0})); }

TEST(Shares, DeviationIsBelowOneItem) {  // both ends deviate by at most half an item
  EXPECT_TRUE(rc::check([] {
    const auto whole = *rc::gen::container<std::vector<unsigned>>(rc::gen::inRange(0u, 100u));
    const std::vector<double> costs(whole.begin(), whole.end());
    const unsigned shares = *rc::gen::inRange(1u, 9u);
    const Firsts first = equal_shares(costs, shares);
    RC_ASSERT(first.size() == shares + 1 && first.front() == 0 && first.back() == costs.size());
    const double part = std::accumulate(costs.begin(), costs.end(), 0.0) / shares;
    for (unsigned k = 0; k < shares; ++k) {
      RC_ASSERT(first[k] <= first[k + 1]);
      const double cost = std::accumulate(costs.begin() + first[k], costs.begin() + first[k + 1], 0.0);
      RC_ASSERT(std::abs(cost - part) <= 100.0);
    }
  }));
}

}  // namespace

}  // namespace sf::cluster
