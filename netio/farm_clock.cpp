#include "netio/farm_clock.h"

#include <algorithm>

#include "netio/bindings.h"

namespace sf::netio {

void FarmClock::see(std::int64_t time, std::int64_t came) {
  const bool anew = !last_ || came - *last_ >= kSilence;
  ahead_ = anew ? time - came : std::max(ahead_, time - came);
  last_ = came;
}

}  // namespace sf::netio
