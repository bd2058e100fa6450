#include "apps/processes/memory_limit.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>

namespace sf::apps {

std::string memory_limit_note() {
  rlim_t least = RLIM_INFINITY;
  for (const auto resource : {RLIMIT_AS, RLIMIT_DATA}) {
    rlimit limit{};
    if (getrlimit(resource, &limit) == 0) least = std::min(least, limit.rlim_cur);
  }
  if (least == RLIM_INFINITY) return "";
  return fmt::format("; memory is limited to {} MiB (ulimit -v), which some libraries cannot handle: raise the limit",
                     least >> 20);
}

}  // namespace sf::apps
