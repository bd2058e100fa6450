#include "tests/ros2/cyclone_peer.h"

namespace sf::ros2 {

CyclonePeer::CyclonePeer(std::uint32_t domain) {
  bridges::DdsOptions options{.domain = domain, .user_data = "enclave=/;", .loopback = true};
  options.receive = [this](bridges::DdsMessage&& message) {
    const std::lock_guard lock(mutex_);
    come_[message.reader].push_back(std::move(message.bytes));
  };
  participant_ = bridges::dds_library().open(options);
}

std::size_t CyclonePeer::subscribe(const std::string& topic, const std::string& type) {
  {
    const std::lock_guard lock(mutex_);
    come_.emplace_back();
  }
  bridges::DdsGuid guid{};
  return participant_->add_reader({.topic = topic, .type = type}, guid);
}

std::size_t CyclonePeer::advertise(const std::string& topic, const std::string& type) {
  bridges::DdsGuid guid{};
  return participant_->add_writer({.topic = topic, .type = type}, guid);
}

std::vector<base::Bytes> CyclonePeer::messages(std::size_t reader) const {
  const std::lock_guard lock(mutex_);
  return come_[reader];
}

}  // namespace sf::ros2
