#include "netio/farm_clock.h"

#include <algorithm>

#include "netio/sender_bindings.h"

namespace sf::netio {

void FarmClock::update(std::int64_t time, std::int64_t arrival) {
  const bool restarted = !last_ || arrival - *last_ >= kSenderTimeout;
  offset_ = restarted ? time - arrival : std::max(offset_, time - arrival);
  last_ = arrival;
}

}  // namespace sf::netio
