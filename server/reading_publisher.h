#pragma once
// Readings to robots: what leaves, in which form.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/reading.h"
#include "base/thread_pool.h"
#include "netio/outbox.h"
#include "sensors/sensor_set.h"
#include "server/stream_layout.h"
#include "world/world.h"

namespace sf::server {

struct PublisherCounts {
  netio::OutboxCounts packets;
  std::uint64_t not_numbers = 0;  ///< packets never made, for a value that is not a number where none may be missing
};

/// A reading on its way to a robot.
struct AddressedReading {
  const base::ReadingBlock* reading = nullptr;
  std::uint32_t address = 0;
  netio::SessionToken session_token;
  netio::PacketSigner* signer = nullptr;  ///< of the robot; null: not signed
};

/// Fleets of more sensors than this are encoded on all cores, and sent by a thread of their own.
inline constexpr std::size_t kLargeFleet = 256;

/// How `sensor_set`'s readings are sent.
netio::OutboxOptions outbox_options(const sensors::SensorSet& sensor_set);

/// Readings as packets, numbered per sensor as they are sent: a reading that was due and never sent leaves no gap.
/// World and roster must outlive it.
class ReadingPublisher {
 public:
  /// @param mirror gets a copy of each packet as well, byte for byte; not with the thesis' packets, which do not say
  /// whose they are
  ReadingPublisher(const world::World& world, const sensors::SensorSet& sensor_set, StreamLayout layout,
                   netio::Outbox outbox, std::optional<netio::Endpoint> mirror = std::nullopt);

  /// Queues each reading's packets to its address, at its sensor's port; none where the layout has none of its
  /// sensor's.
  void queue(std::span<const AddressedReading> readings);
  void flush() { outbox_.flush(); }
  PublisherCounts counts() const { return {outbox_.counts(), not_numbers_}; }

 private:
  /// One sensor's stream.
  struct Stream {
    std::uint32_t sent = 0;   ///< readings
    std::uint32_t parts = 0;  ///< datagrams of a reading; 0: it is not sent
  };
  /// A reading that is being encoded.
  struct Job {
    AddressedReading addressed;
    const sensors::SensorType* type = nullptr;
    const sensors::SensorSpec* row = nullptr;
    Stream* stream = nullptr;
    std::uint32_t sequence = 0;
    std::size_t place = 0;      ///< of its first datagram
    std::uint64_t counter = 0;  ///< of its first datagram's signature
    bool whole = true;          ///< every part is numbers
  };
  struct Memory {
    base::Bytes payload, packet;
  };
  Job make_job(const AddressedReading& addressed);
  /// Of a reading, copies included.
  std::size_t datagrams_of(const Stream& stream) const { return stream.parts * (mirror_ ? 2u : 1u); }
  void encode_all();
  void encode_and_queue(Job& job);
  template <class Put>
  std::uint32_t encode(const Job& job, Memory& memory, Put&& put) const;

  const world::World& world_;
  const sensors::SensorSet& sensor_set_;
  StreamLayout layout_;
  netio::Outbox outbox_;
  std::optional<netio::Endpoint> mirror_;
  base::ThreadPool thread_pool_;
  std::map<std::uint8_t, std::vector<Stream>> streams_;  ///< by type, per row of its group
  std::vector<Job> jobs_;
  std::vector<Memory> memory_;  ///< per thread
  std::uint64_t not_numbers_ = 0;
};

}  // namespace sf::server
