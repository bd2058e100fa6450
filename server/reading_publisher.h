#pragma once
// Sends readings to robots as packets.

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
  std::uint64_t not_numbers = 0;  ///< packets not sent because a required value is not a number
};

/// A reading with the robot it is sent to.
struct AddressedReading {
  const base::ReadingBlock* reading = nullptr;
  std::uint32_t address = 0;
  netio::SessionToken session_token;
  netio::PacketSigner* signer = nullptr;  ///< of the robot; null: unsigned
};

/// Fleets with more sensors are encoded on all cores and sent by a separate thread.
inline constexpr std::size_t kLargeFleet = 256;

/// Returns how the readings of `sensor_set` are sent.
netio::OutboxOptions outbox_options(const sensors::SensorSet& sensor_set);

/// Encodes readings as packets, numbered per sensor in the order of sending. A reading that was due but never sent
/// leaves no gap. The world and the roster must outlive it.
class ReadingPublisher {
 public:
  /// @param mirror receives a byte-identical copy of each packet; not allowed with the thesis' packets, which do not
  /// name their sensor
  ReadingPublisher(const world::World& world, const sensors::SensorSet& sensor_set, StreamLayout layout,
                   netio::Outbox outbox, std::optional<netio::Endpoint> mirror = std::nullopt);

  /// Queues each reading's packets for its address, at the port of its sensor. Skips sensors without a port in the
  /// layout.
  void queue(std::span<const AddressedReading> readings);
  void flush() { outbox_.flush(); }
  PublisherCounts counts() const { return {outbox_.counts(), not_numbers_}; }

 private:
  /// The stream of one sensor.
  struct Stream {
    std::uint32_t sent = 0;   ///< number of readings
    std::uint32_t parts = 0;  ///< datagrams per reading; 0: not sent
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
    bool whole = true;          ///< every part contains only numbers
  };
  struct Memory {
    base::Bytes payload, packet;
  };
  Job make_job(const AddressedReading& addressed);
  /// Datagrams of a reading, copies included.
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
