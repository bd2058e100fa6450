#include "bridges/viewer_sessions.h"

#include <algorithm>

namespace sf::bridges {

void ViewerWishes::subscribe(std::uint32_t topic, bool on) {
  const std::lock_guard lock(mutex_);
  std::uint32_t& count = subscribers_[topic];
  if (on) {
    ++count;
    subscribed_.insert(topic);
    fresh_.insert(topic);
  } else if (--count == 0) {
    subscribed_.erase(topic);
    fresh_.erase(topic);
  }
}

void ViewerWishes::topics(std::vector<std::uint32_t>& all, std::vector<std::uint32_t>& fresh) {
  const std::lock_guard lock(mutex_);
  all.insert(all.end(), subscribed_.begin(), subscribed_.end());
  fresh.insert(fresh.end(), fresh_.begin(), fresh_.end());
  fresh_.clear();
}

void ViewerWishes::command(const Command& command) {
  const std::lock_guard lock(mutex_);
  const auto of_mover = [&](const Command& other) { return other.mover == command.mover; };
  std::erase_if(requests_.commands, of_mover);
  requests_.commands.push_back(command);
}

void ViewerWishes::pause(bool paused) {
  const std::lock_guard lock(mutex_);
  requests_.paused = paused;
}

void ViewerWishes::step() {
  constexpr std::uint32_t kMostSteps = 10'000;
  const std::lock_guard lock(mutex_);
  requests_.paused = true;
  requests_.steps = std::min(requests_.steps + 1, kMostSteps);
}

void ViewerWishes::speed(double speed) {
  const std::lock_guard lock(mutex_);
  requests_.speed = speed;
}

void ViewerWishes::reset() {
  const std::lock_guard lock(mutex_);
  requests_.reset = true;
}

void ViewerWishes::seek(std::int64_t time) {
  const std::lock_guard lock(mutex_);
  requests_.time = time;
}

void ViewerWishes::take(Requests& requests) {
  const std::lock_guard lock(mutex_);
  requests.add(requests_);
}

}  // namespace sf::bridges
