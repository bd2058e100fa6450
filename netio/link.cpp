#include "netio/link.h"

#include <cmath>

#include "base/random.h"

namespace sf::netio {

std::optional<std::int64_t> fate(const LinkPlan& plan, const Message& message) {
  if (plan.perfect()) return 0;
  const base::RandomKey draw{plan.seed, base::RandomStream::link, message.robot, message.stream, message.sequence};
  const auto chance = base::random_uniform(draw, 0);
  if (chance[0] < plan.loss) return std::nullopt;
  return std::llround(1e9 * (plan.delay + plan.jitter * chance[1]));
}

}  // namespace sf::netio
