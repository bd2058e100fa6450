#include "netio/link_model.h"

#include <cmath>

#include "base/random.h"
#include "base/time.h"

namespace sf::netio {

std::optional<std::int64_t> sample_delay(const LinkModel& model, const MessageId& message) {
  if (model.perfect()) return 0;
  const base::RandomKey draw{model.seed, base::RandomStream::link, message.robot, message.stream, message.sequence};
  const auto chance = base::random_uniform(draw, 0);
  if (chance[0] < model.loss) return std::nullopt;
  return base::nanoseconds(model.delay + model.jitter * chance[1]);
}

}  // namespace sf::netio
