#pragma once
// One small HTTP and WebSocket server on a thread of its own. It serves files from memory and carries messages between
// WebSocket clients and a `WebApplication`.
//
// Nothing that a client does or leaves undone makes a caller wait or lets memory grow without a bound: see `WebLimits`.

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
  std::size_t connections = 64;         ///< at a time, clients included; further ones are closed at once
  std::size_t clients = 16;             ///< WebSockets at a time; further ones are refused
  std::size_t message = 1 << 20;        ///< [byte] of a message from a client; a longer one ends its connection
  std::size_t replies = 4 << 20;        ///< [byte] of replies that a client has not taken; more end its connection
  std::size_t waiting_updates = 3;      ///< updates that wait behind the one being sent; the oldest is left out
  std::size_t waiting_bytes = 8 << 20;  ///< [byte] of such updates, unless there is one only
};

struct WebFile {
  std::string type;         ///< such as "text/html"
  std::string_view text;    ///< lives as long as the server
  bool is_private = false;  ///< served with the token only
};

struct WebOptions {
  WebAddress address;
  std::vector<std::string> protocols;    ///< WebSocket sub-protocols; a client must offer one of them
  std::map<std::string, WebFile> files;  ///< by path, such as "/"
  WebLimits limits;
};

/// One message to a client: a few bytes of its own, and a body that many share.
struct WebMessage {
  std::array<std::uint8_t, 13> head{};
  std::uint8_t head_size = 0;
  bool is_text = false;
  std::shared_ptr<const base::Bytes> body;  ///< null: none
  bool is_lasting = false;                  ///< `body` is kept anyway, and does not count as a reply's bytes

  std::size_t size() const { return head_size + (body ? body->size() : 0); }
};

using ClientId = std::uint64_t;  ///< never given twice

/// Called on the server's thread only.
class WebApplication {
 public:
  virtual ~WebApplication() = default;
  /// @param protocol one of `WebOptions::protocols`: the first that the client offered
  virtual void opened(ClientId client, const std::string& protocol) = 0;
  /// @param bytes live during the call
  virtual void received(ClientId client, bool is_text, std::span<const std::uint8_t> bytes) = 0;
  virtual void closed(ClientId client) = 0;
};

class WebServer {
 public:
  class Implementation;

  /// Listens, and starts the thread. @param application outlives the server
  /// @throws base::InputError when the address cannot be had
  WebServer(WebOptions options, WebApplication& application);
  /// Closes all connections and ends the thread.
  ~WebServer();

  std::uint16_t port() const { return port_; }
  /// Needed by all requests where the address is not a loopback address, and by pages of unknown origin.
  const std::string& token() const { return token_; }
  /// "http://127.0.0.1:8765/", with the token where it is needed.
  std::string url() const;
  /// Updates that were left out for slow clients. Any thread.
  std::uint64_t skipped() const { return skipped_; }

  /// Runs a function on the server's thread. Any thread; never waits.
  void post(std::function<void()> function);

  // The server's thread only; nothing happens for clients that are gone.

  /// Replies are kept until the client takes them.
  void reply(ClientId client, WebMessage message);
  /// The messages of one tick, in order: sent whole or, where the client is behind, left out whole.
  void update(ClientId client, std::vector<WebMessage> messages);

 private:
  std::string token_;
  WebAddress address_;
  std::uint16_t port_ = 0;
  std::atomic<std::uint64_t> skipped_ = 0;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sf::bridges
