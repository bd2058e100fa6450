#pragma once
// A Cyclone DDS participant on the loopback interface, by the plug-in: a client of services, like rmw_cyclonedds.

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "bridges/dds.h"

namespace sf::ros2 {

class CyclonePeer {
 public:
  explicit CyclonePeer(std::uint32_t domain);

  /// @return the reader's number
  std::size_t subscribe(const std::string& topic, const std::string& type);
  /// @return the writer's number
  std::size_t advertise(const std::string& topic, const std::string& type);
  void send(std::size_t writer, const base::Bytes& message) { participant_->write(writer, message); }
  bool matched_writer(std::size_t writer) const { return participant_->count_readers(writer) > 0; }
  std::vector<base::Bytes> messages(std::size_t reader) const;  ///< all received messages

 private:
  mutable std::mutex mutex_;
  std::vector<std::vector<base::Bytes>> come_;  ///< by reader
  std::unique_ptr<bridges::DdsParticipant> participant_;
};

}  // namespace sf::ros2
