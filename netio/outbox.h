#pragma once
// Sends datagrams in batches from preallocated storage, without blocking the tick for long.
//
//   Outbox outbox;
//   outbox.queue({address, port}, bytes);   // copies
//   outbox.flush();                         // once per tick
//
// One caller at a time, except for `put`.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "netio/endpoint.h"
#include "netio/packets.h"
#include "netio/signature.h"
#include "netio/socket.h"

namespace sf::netio {

struct OutboxOptions {
  Endpoint bind = {0, 0};              ///< source address; 0.0.0.0: the route determines the interface
  std::size_t capacity = 1024;         ///< datagrams; a full outbox flushes automatically
  std::size_t send_buffer = 1u << 20;  ///< [byte] requested from the kernel
  int patience_ms = 5;                 ///< [ms] longest wait for a full socket per flush; the rest is then dropped
  /// > 0: a separate thread sends. At most this number of flushes are queued for it, and further flushes are dropped,
  /// so that a slow network does not block the caller.
  std::size_t backlog = 0;
};

struct OutboxCounts {
  std::uint64_t queued = 0;      ///< sent + failed + dropped + still waiting for a flush
  std::uint64_t sent = 0;        ///< passed to the kernel
  std::uint64_t sent_bytes = 0;  ///< UDP payload of the sent datagrams
  std::uint64_t failed = 0;      ///< rejected by the kernel: unreachable network, no permission to broadcast, ...
  std::uint64_t dropped = 0;     ///< the socket stayed full for `patience_ms`, or the backlog was full
  std::string first_failure;     ///< "192.0.2.1:10000: Network is unreachable"; empty while failed is 0
  double busy_s = 0.0;           ///< [s] spent sending
};

class Outbox {
 public:
  /// @throws base::InputError if no socket can be opened or bound
  explicit Outbox(const OutboxOptions& options = {});
  /// Sends through an open socket. Ignores `bind` and `send_buffer` of the options.
  explicit Outbox(Socket socket, const OutboxOptions& options = {});
  /// Sends all flushed datagrams.
  ~Outbox();
  Outbox(Outbox&&) noexcept;

  /// Copies at most kMaxHeaderlessDatagram bytes for the next flush.
  void queue(const Endpoint& to, std::span<const std::uint8_t> bytes);
  /// Does the same for an encoded packet: writes `session_token` into the copy, which `signer` (null: none) then signs.
  void queue(const Endpoint& to, std::span<const std::uint8_t> bytes, const SessionToken& session_token,
             PacketSigner* signer = nullptr);

  /// Reserves consecutive slots for `count` <= capacity datagrams, and flushes first if there is not enough room.
  /// Before any other call, every slot must be filled with `put`, from any thread, or all slots must be returned with
  /// `give_back`.
  /// @return index of the first slot
  std::size_t claim(std::size_t count);
  void put(std::size_t place, const Endpoint& to, std::span<const std::uint8_t> bytes);
  void give_back(std::size_t count);
  std::size_t capacity() const;

  /// Sends all queued datagrams, in order.
  void flush();

  /// Waits until all flushed datagrams are sent.
  OutboxCounts counts() const;
  Endpoint endpoint() const;

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace sf::netio
