#pragma once
// Datagrams out: queued into storage made once, sent many at a time, never holding the tick for more than a moment.
//
//   Outbox outbox;
//   outbox.queue({address, port}, bytes);   // copies
//   outbox.flush();                         // once per tick
//
// One caller at a time, but for `put`.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "netio/endpoint.h"
#include "netio/packets.h"
#include "netio/socket.h"

namespace sf::netio {

struct OutboxOptions {
  Endpoint bind = {0, 0};              ///< where packets come from; 0.0.0.0 lets the route choose the interface
  std::size_t capacity = 1024;         ///< datagrams held; a full outbox flushes itself
  std::size_t send_buffer = 1u << 20;  ///< [byte] asked of the kernel
  int patience_ms = 5;  ///< longest wait in one flush for a full socket; what is still unsent then is dropped
  /// > 0: a thread of its own sends, while the caller goes on. So many flushes may wait for it; what is flushed while
  /// as many wait is dropped, so that a slow network holds up nobody.
  std::size_t backlog = 0;
};

struct OutboxCounts {
  std::uint64_t queued = 0;      ///< sent + failed + dropped + those still waiting for a flush
  std::uint64_t sent = 0;        ///< handed to the kernel
  std::uint64_t sent_bytes = 0;  ///< UDP payload of these
  std::uint64_t failed = 0;      ///< refused by the kernel: unreachable network, no permission to broadcast, ...
  std::uint64_t dropped = 0;     ///< the socket stayed full for `patience_ms`, or the backlog was full
  std::string first_failure;     ///< "192.0.2.1:10000: Network is unreachable"; empty while failed is 0
  double busy_s = 0.0;           ///< [s] spent sending
};

class Outbox {
 public:
  /// @throws base::InputError when no socket can be opened or bound.
  explicit Outbox(const OutboxOptions& options = {});
  /// Through a socket that is open already; `bind` and `send_buffer` of the options say nothing.
  explicit Outbox(Socket socket, const OutboxOptions& options = {});
  /// Sends what was flushed.
  ~Outbox();
  Outbox(Outbox&&) noexcept;

  /// Keeps a copy of at most kMaxHeaderlessDatagram bytes for the next flush.
  void queue(const Endpoint& to, std::span<const std::uint8_t> bytes);
  /// The same with another stamp: `bytes` are an encoded packet.
  void queue(const Endpoint& to, std::span<const std::uint8_t> bytes, const SessionToken& session_token);

  /// Room for `count` <= capacity datagrams, in this order: flushes first where there is too little. Each is to be
  /// `put`, by any thread, before anything else is asked of the outbox; or all are given back.
  /// @return the first one's place; the others follow.
  std::size_t claim(std::size_t count);
  void put(std::size_t place, const Endpoint& to, std::span<const std::uint8_t> bytes);
  void give_back(std::size_t count);
  std::size_t capacity() const;

  /// Sends all that is queued, in order.
  void flush();

  /// Waits until all that was flushed is sent.
  OutboxCounts counts() const;
  Endpoint endpoint() const;

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace sf::netio
