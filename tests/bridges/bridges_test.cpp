// All bridges of a run together.

#include <gtest/gtest.h>

#include <memory>

#include "bridges/bridge.h"

namespace sf::bridges {

namespace {

/// Counts its calls, and requests one step.
struct Counting : Bridge {
  explicit Counting(int& count) : ticks(count) {}
  void publish(const base::TickRecord&, const RunState&) override { ++ticks; }
  void publish(const RunState&) override { ticks += 100; }
  void take(Requests& requests) override {
    ++requests.steps;
    requests.commands.push_back({static_cast<std::uint32_t>(ticks), {}});
  }
  std::string describe() const override { return "counting"; }
  int& ticks;
};

}  // namespace

TEST(Bridges, EachReceivesEveryTickAndIsPolled) {
  int first = 0, second = 5;
  Bridges bridges;
  EXPECT_TRUE(bridges.empty());
  bridges.add(std::make_unique<Counting>(first));
  bridges.add(std::make_unique<Counting>(second));
  bridges.publish(base::TickRecord{}, {});
  EXPECT_EQ(first, 1);
  EXPECT_EQ(second, 6);
  bridges.publish(RunState{.paused = true});
  EXPECT_EQ(first, 101);
  Requests requests;
  for (int round = 0; round < 2; ++round) {  // a request is delivered only once
    bridges.take(requests);
    EXPECT_EQ(requests.steps, 2u);
    ASSERT_EQ(requests.commands.size(), 2u);
    EXPECT_EQ(requests.commands[1].mover, 106u) << "in the order of the bridges";
  }
  EXPECT_EQ(bridges.describe().size(), 2u);
}

TEST(Requests, AddInOrder) {
  Requests first, later;
  first.paused = true;
  first.steps = 2;
  first.speed = 2.0;
  first.commands.push_back({1, {}});
  later.paused = false;
  later.steps = 1;
  later.time = 5;
  later.reset = true;
  later.commands.push_back({2, {}});
  first.add(later);
  EXPECT_EQ(first.paused, false);
  EXPECT_EQ(first.speed, 2.0);
  EXPECT_EQ(first.time, 5);
  EXPECT_EQ(first.steps, 3u);
  EXPECT_TRUE(first.reset);
  ASSERT_EQ(first.commands.size(), 2u);
  EXPECT_EQ(first.commands[1].mover, 2u);
  EXPECT_TRUE(later.commands.empty());
  EXPECT_FALSE(later.paused || later.time || later.reset || later.steps > 0);
}

}  // namespace sf::bridges
