// Figures need no display: the tests unset it even if the machine has one.

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
