#include "base/error.h"

#include <cstdio>
#include <cstdlib>

namespace sf::base {

void check(bool condition, const char* file, int line, const std::string& message) {
  if (condition) return;
  std::fprintf(stderr, "%s:%d: broken contract: %s\n", file, line, message.c_str());
  std::abort();
}

}  // namespace sf::base
