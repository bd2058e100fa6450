#pragma once
// Finds sockets that a library opens, by comparing the open descriptors.

#include <set>
#include <string>

namespace sf::netio {

/// Holds the descriptors that this process had open at construction.
class OpenSockets {
 public:
  OpenSockets();

  /// Restricts UDP sockets over IPv4 that were opened since on all interfaces to datagrams from this machine's
  /// loopback. Cyclone DDS binds its receiving sockets to 0.0.0.0, whatever the interface.
  /// @throws base::InputError if the kernel refuses
  void keep_new_ones_to_loopback() const;
  /// Returns the addresses of this machine, without 0.0.0.0, that UDP sockets over IPv4 opened since are bound to.
  /// Cyclone DDS binds its sending sockets to its interfaces.
  std::set<std::string> addresses() const;

 private:
  std::set<int> before_;
};

}  // namespace sf::netio
