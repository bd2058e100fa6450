#include "server/drop_notices.h"

#include <algorithm>

namespace sf::server {

void DropNotices::add(std::uint32_t robot, std::uint8_t type, std::uint32_t sensor, Reason reason, std::int64_t time) {
  Sensor& of = sensors_[robot][{type, sensor}];
  of.counts.type = type;
  ++(reason == Reason::processor ? of.counts.processor : of.counts.network);
  of.time = std::max(of.time, time);
  of.news = true;
}

void DropNotices::publish(std::int64_t now, StateReceiver& receiver) {
  for (auto& [id, sensors] : sensors_) {
    if (!receiver.inbox().is_active(id, now)) continue;
    for (auto& [key, of] : sensors) {
      const bool due = of.news ? now - of.sent >= kPeriod : !of.repeated && now - of.sent >= kRepeat;
      if (!due) continue;
      of.repeated = !of.news;
      of.news = false;
      of.sent = now;
      netio::encode({.robot = static_cast<std::uint16_t>(id),
                     .sensor = static_cast<std::uint16_t>(key.second),
                     .sequence = sequences_[id]++,
                     .time = of.time},
                    of.counts, packet_);
      receiver.queue(id, packet_);
    }
  }
}

}  // namespace sf::server
