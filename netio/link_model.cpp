#include "netio/link_model.h"

#include <cmath>

#include "base/random.h"
#include "base/time.h"

namespace sf::netio {

namespace {

base::RandomKey key_of(const LinkModel& model, const MessageId& message) {
  return {model.seed, base::RandomStream::link, message.robot, message.stream, message.sequence};
}

}  // namespace

std::optional<std::int64_t> sample_delay(const LinkModel& model, const MessageId& message) {
  if (model.perfect()) return 0;
  const auto chance = base::random_uniform(key_of(model, message), 0);
  if (chance[0] < model.loss) return std::nullopt;
  return base::nanoseconds(model.delay + model.jitter * chance[1]);
}

MessageFaults sample_faults(const LinkModel& model, const MessageId& message) {
  MessageFaults faults;
  if (model.duplicate == 0.0 && model.corrupt == 0.0) return faults;
  const auto chance = base::random_uniform(key_of(model, message), 1);
  const auto place = base::random_uniform(key_of(model, message), 2);
  if (chance[0] < model.duplicate) faults.again = base::nanoseconds(model.delay + model.jitter * place[0]);
  if (chance[1] < model.corrupt) faults.flipped_bit = place[1];
  return faults;
}

}  // namespace sf::netio
