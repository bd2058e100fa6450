#pragma once
// Sends readings to robots as packets.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/reading.h"
#include "base/thread_pool.h"
#include "farm/token_bucket.h"
#include "netio/outbox.h"
#include "sensors/image_packets.h"
#include "sensors/sensor_set.h"
#include "server/stream_layout.h"
#include "world/world.h"

namespace sf::server {

struct PublisherCounts {
  netio::OutboxCounts packets;
  std::uint64_t dropped = 0;      ///< readings beyond the limit of bytes
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
  /// @param now [ns] does not decrease; needed for a limit only
  void queue(std::span<const AddressedReading> readings, std::int64_t now = 0);
  /// Limits the bytes of datagrams, copies included. Readings with the lowest priority that exceed the limit are
  /// dropped, never delayed. Equal ones take turns.
  /// @param rate [byte/s] > 0 @param burst [byte] > 0
  void limit(double rate, double burst) { bucket_.emplace(rate, burst); }
  /// Returns the readings that the last call of `queue` dropped. Valid until the next.
  std::span<const base::ReadingBlock* const> dropped() const { return dropped_; }
  void flush() { outbox_.flush(); }
  PublisherCounts counts() const { return {outbox_.counts(), dropped_readings_, not_numbers_}; }

 private:
  /// The stream of one sensor.
  struct Stream {
    std::uint32_t sent = 0;   ///< number of readings
    std::uint32_t parts = 0;  ///< datagrams per reading; 0: not sent
    std::uint32_t bytes = 0;  ///< of its last reading, copies included; 0: none was sent
    std::uint64_t last = 0;   ///< call of `queue` in which a reading was last admitted
  };
  /// A reading that is being encoded.
  struct Job {
    AddressedReading addressed;
    const sensors::SensorType* type = nullptr;
    const sensors::SensorSpec* row = nullptr;
    Stream* stream = nullptr;
    std::uint32_t sequence = 0;
    sensors::ImageFile image;   ///< of a camera's colours; empty: none
    std::uint32_t parts = 0;    ///< datagrams, those of the file included
    std::size_t place = 0;      ///< of its first datagram
    std::uint64_t counter = 0;  ///< of its first datagram's signature
    bool whole = true;          ///< every part contains only numbers
    std::uint32_t bytes = 0;    ///< of its datagrams, copies included
  };
  struct Memory {
    base::Bytes payload, packet;
  };
  Job make_job(const AddressedReading& addressed);
  Stream& stream_of(const base::ReadingBlock& reading);
  std::span<const AddressedReading> admit(std::span<const AddressedReading> readings, std::int64_t now);
  void charge();
  /// Datagrams of a reading, copies included.
  std::size_t datagrams_of(std::uint32_t parts) const { return parts * (mirror_ ? 2u : 1u); }
  /// Bytes of a reading whose size is not known yet, at least.
  double least_bytes(const Stream& stream) const {
    return static_cast<double>(datagrams_of(stream.parts) * netio::kHeaderBytes);
  }
  void encode_all();
  void encode_and_queue(Job& job);
  template <class Put>
  std::uint32_t encode(Job& job, Memory& memory, Put&& put) const;

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
  std::optional<farm::TokenBucket> bucket_;  ///< [byte] nullopt: no limit
  std::uint64_t calls_ = 0;
  std::vector<std::uint32_t> order_;  ///< of the readings of one call, by priority
  std::vector<std::uint8_t> admitted_;
  std::vector<AddressedReading> admitted_readings_;
  std::vector<const base::ReadingBlock*> dropped_;
  std::uint64_t dropped_readings_ = 0;
};

}  // namespace sf::server
