// No figure may need a display: whatever the machine has, the tests run without one.

#include <gtest/gtest.h>

#include <cstdlib>

namespace {

class NoDisplay : public testing::Environment {
 public:
  void SetUp() override {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
  }
};

[[maybe_unused]] testing::Environment* const no_display = testing::AddGlobalTestEnvironment(new NoDisplay);

}  // namespace
