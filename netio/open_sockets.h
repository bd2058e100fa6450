#pragma once
// Sockets that a library opens, found by comparison.

#include <set>
#include <string>

namespace sf::netio {

/// Descriptors of this process at the time of its construction.
class OpenSockets {
 public:
  OpenSockets();

  /// Makes UDP sockets of IPv4 that were opened since, on all interfaces, receive from this machine's loopback alone:
  /// Cyclone DDS binds those that receive to 0.0.0.0, whatever the interface.
  /// @throws base::InputError where the kernel refuses
  void keep_new_ones_to_loopback() const;
  /// Addresses of this machine that UDP sockets of IPv4 that were opened since are bound to, without 0.0.0.0: Cyclone
  /// DDS binds those that send to its interfaces.
  std::set<std::string> addresses() const;

 private:
  std::set<int> before_;
};

}  // namespace sf::netio
