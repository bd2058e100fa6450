// Counts every `new` of this program: ticks must not allocate.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "robots/fleet.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace {
std::atomic<long> allocations{0};
}

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace sf::robots {
namespace {

TEST(Allocation, CounterWorks) {
  const long before = allocations;
  ::operator delete(::operator new(100));  // called by name, so it cannot be optimised away
  EXPECT_EQ(allocations - before, 1);
}

TEST(Allocation, MovingAndCollidingRobotsDoNotAllocate) {
  world::World world = scenes::boxed_world(6, 6);
  for (int i = 0; i < 36; ++i) scenes::add_create(world, {0.5 + i % 6, 0.5 + i / 6, 0, 0.7 * i});
  Fleet fleet(world);
  const std::vector<base::Twist> commands(36, {0.5, 0, 0.3});
  long contacts = 0;
  const long before = allocations;
  for (int tick = 0; tick < 200; ++tick) {
    fleet.move(commands, kTick);
    fleet.predict(tick * kTick);
    for (const auto contact : fleet.contacts()) contacts += contact;
  }
  EXPECT_EQ(allocations - before, 0);
  EXPECT_GT(contacts, 0);
}

}  // namespace
}  // namespace sf::robots
