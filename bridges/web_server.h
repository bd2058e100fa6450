#pragma once
// A small HTTP and WebSocket server on its own thread. It serves files from memory and carries messages between
// WebSocket clients and a `WebApplication`.
//
// No behaviour of a client can block a caller or let memory grow without bound: see `WebLimits`.

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "bridges/web_access.h"

namespace sf::bridges {

struct WebLimits {
  std::size_t connections = 64;     ///< maximum at a time, clients included; others are closed immediately
  std::size_t clients = 16;         ///< maximum number of WebSockets at a time; others are refused
  std::size_t message = 1 << 20;    ///< [byte] maximum size of a client's message; a longer one closes its connection
  std::size_t replies = 4 << 20;    ///< [byte] maximum size of unsent replies to a client; more close its connection
  std::size_t waiting_updates = 3;  ///< maximum number of updates queued behind the current one; the oldest is dropped
  std::size_t waiting_bytes = 8 << 20;  ///< [byte] maximum size of queued updates, unless there is only one
};

struct WebFile {
  std::string type;         ///< for example "text/html"
  std::string_view text;    ///< outlives the server
  bool is_private = false;  ///< served only with the token
};

struct WebOptions {
  WebAddress address;
  std::vector<std::string> protocols;    ///< WebSocket sub-protocols; a client must offer at least one
  std::map<std::string, WebFile> files;  ///< by path, for example "/"
  WebLimits limits;
};

/// One message to a client: a few bytes of its own, and a body that messages to several clients share.
struct WebMessage {
  std::array<std::uint8_t, 13> head{};
  std::uint8_t head_size = 0;
  bool is_text = false;
  std::shared_ptr<const base::Bytes> body;  ///< null: none
  bool is_lasting = false;  ///< whether `body` is retained elsewhere and excluded from the size of replies

  std::size_t size() const { return head_size + (body ? body->size() : 0); }
};

using ClientId = std::uint64_t;  ///< never reused

/// Called only on the server's thread.
class WebApplication {
 public:
  virtual ~WebApplication() = default;
  /// @param protocol first protocol offered by the client that is in `WebOptions::protocols`
  virtual void opened(ClientId client, const std::string& protocol) = 0;
  /// @param bytes valid during the call
  virtual void received(ClientId client, bool is_text, std::span<const std::uint8_t> bytes) = 0;
  virtual void closed(ClientId client) = 0;
};

class WebServer {
 public:
  class Implementation;

  /// Listens and starts the thread.
  /// @param application outlives the server
  /// @throws base::InputError if the address is unavailable
  WebServer(WebOptions options, WebApplication& application);
  /// Closes all connections and ends the thread.
  ~WebServer();

  std::uint16_t port() const { return port_; }
  /// Required by all requests if the address is not a loopback address, and by pages of unknown origin.
  const std::string& token() const { return token_; }
  /// Returns "http://127.0.0.1:8765/", with the token if required.
  std::string url() const;
  /// Returns the number of updates dropped for slow clients. Thread-safe.
  std::uint64_t skipped() const { return skipped_; }

  /// Runs a function on the server's thread. Thread-safe; never blocks.
  void post(std::function<void()> function);

  /// Replaces the text of a file. Server's thread only.
  /// @param text outlives the server
  void set_file(const std::string& path, std::string_view text);

  // Server's thread only. These functions do nothing for closed clients.

  /// Queues a reply until it is sent.
  void reply(ClientId client, WebMessage message);
  /// Sends the messages of one tick, in order. Drops them together if the client is behind.
  void update(ClientId client, std::vector<WebMessage> messages);

 private:
  std::string token_;
  WebAddress address_;
  std::uint16_t port_ = 0;
  std::atomic<std::uint64_t> skipped_ = 0;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sf::bridges
