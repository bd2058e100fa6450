#pragma once
// The other end of a run: takes every sensor's packets on its own port, counts and checks them.
//
// One socket per port, since Linux has no way for an ordinary user to take a range of ports with one; one epoll set
// over all, so that a thousand quiet ports cost nothing, and recvmmsg on each that has something.
//
//   Listener listener({.streams = streams});      // ports are bound when this returns: start the sender now
//   listener.run(stop, 500);                      // or drain(), between other work
//   Summary summary = listener.summary();
//
// One thread; only `stop` may be set by another.

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "netio/endpoint.h"
#include "netio/laser_packets.h"
#include "netio/ports.h"
#include "netio/reason.h"

namespace sf::netio {

/// What to expect on one port.
struct StreamPlan {
  std::uint32_t robot = 0;
  std::uint32_t sensor = 0;
  std::uint32_t samples = 0;  ///< rays of each scan; 0: any number
  double range_max =
      0.0;  ///< [m] no finite range may be larger by more than 1 mm (saturated words aside); 0: not checked
  PortRule rule;
};

struct ListenerOptions {
  std::uint32_t address = kLoopback;
  std::size_t receive_buffer = 1u << 20;  ///< [byte] per port, asked of the kernel
  Wire wire = Wire::farm;                 ///< the thesis' layout has no sequence: loss and order cannot be seen in it
  std::vector<StreamPlan> streams;        ///< one per sensor
};

struct Summary {
  std::uint64_t datagrams = 0;
  std::uint64_t bytes = 0;  ///< UDP payload
  std::uint64_t rays = 0;   ///< in good datagrams
  std::uint64_t good = 0;   ///< decoded, plausible, and what their port should carry
  Counts counts;            ///< the same datagrams by reason
  std::uint64_t lost = 0;   ///< by gaps in sequences from 0; see Track
  std::uint64_t duplicates = 0;
  std::uint64_t reordered = 0;
  std::uint64_t ports = 0;
  std::uint64_t silent_ports = 0;  ///< nothing good came
  std::size_t receive_buffer = 0;  ///< [byte] granted to the first port
};

class Listener {
 public:
  /// Binds all ports, raising the limit of open files as needed.
  /// @throws base::InputError when ports collide, are taken, or are more than the machine allows.
  explicit Listener(const ListenerOptions& options);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// Waits at most `timeout_ms` (0: not at all) for something to come, then takes all that waits. Returns datagrams
  /// taken.
  std::size_t drain(int timeout_ms = 0);

  /// Drains until `stop` is set, or until nothing came for `silence_ms` after the first datagram; then takes what still
  /// waits.
  void run(const std::atomic<bool>& stop, int silence_ms);

  /// One datagram for stream `i`, from wherever: decides and counts. drain() is this for sockets.
  Reason accept(std::size_t i, std::span<const std::uint8_t> bytes);

  Summary summary() const;

 private:
  struct Streams;
  std::unique_ptr<Streams> streams_;
};

}  // namespace sf::netio
