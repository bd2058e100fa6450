#pragma once
// A WebSocket client at byte level (RFC 6455), so that tests can also send invalid data.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

namespace sf::bridges {

class RawClient {
 public:
  /// @param at_once false: `connect_now` connects
  explicit RawClient(std::uint16_t port, bool at_once = true)
      : socket_(::socket(AF_INET, SOCK_STREAM, 0)), port_(port) {
    // Prevents an endless wait if the server does not answer; not used for measurements.
    const timeval limit{30, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
    ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof(limit));
    if (at_once) connect_now();
  }
  bool connect_now() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port_);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return connected_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  ~RawClient() { ::close(socket_); }

  bool connected() const { return connected_; }
  bool send_raw(std::string_view bytes) {
    while (!bytes.empty()) {
      const auto sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

  /// Sends a request.
  /// @return the head of the answer, empty if the connection ended
  std::string request(const std::string& target, const std::string& headers, const char* method = "GET") {
    send_raw(method + std::string(" ") + target + " HTTP/1.1\r\n" + headers + "\r\n");
    std::string head;
    while (!head.ends_with("\r\n\r\n")) {
      const std::string byte = read(1);
      if (byte.empty()) return {};
      head += byte;
    }
    return head;
  }
  /// Requests a WebSocket.
  /// @return the status line
  std::string upgrade(const std::string& protocol, const std::string& more = "", const std::string& target = "/",
                      const std::string& host = "localhost") {
    const std::string offer = protocol.empty() ? "" : "Sec-WebSocket-Protocol: " + protocol + "\r\n";
    head_ = request(target, "Host: " + host + "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" +
                                "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n" + offer +
                                more);
    return head_.substr(0, head_.find('\r'));
  }
  const std::string& head() const { return head_; }

  /// @param opcode 1 text, 2 binary
  bool send_frame(int opcode, std::string_view payload, std::optional<std::uint64_t> claimed = {}) {
    const std::uint64_t size = claimed.value_or(payload.size());
    std::string frame(1, static_cast<char>(0x80 | opcode));
    frame += static_cast<char>(0x80 | (size < 126 ? size : size < 65536 ? 126 : 127));
    if (size >= 126)
      for (int shift = size < 65536 ? 8 : 56; shift >= 0; shift -= 8) frame += static_cast<char>(size >> shift & 255);
    frame.append(4, '\0');  // a mask without effect
    return send_raw(frame.append(payload));
  }
  bool text(std::string_view message) { return send_frame(1, message); }

  struct Message {
    int opcode = 0;
    std::string payload;
  };
  /// Returns nullopt if the connection ended. Skips pings.
  std::optional<Message> receive() {
    for (;;) {
      const std::string head = read(2);
      if (head.size() < 2) return std::nullopt;
      std::uint64_t size = head[1] & 0x7F;
      if (size >= 126) {
        const std::string more = read(size == 126 ? 2 : 8);
        size = 0;
        for (const char byte : more) size = size << 8 | static_cast<std::uint8_t>(byte);
      }
      Message message{head[0] & 15, read(size)};
      if (message.payload.size() < size || message.opcode == 8) return std::nullopt;
      if (message.opcode < 8) return message;
    }
  }
  /// Returns the first message that contains `part`; empty if the connection ended.
  std::string receive_with(std::string_view part) {
    while (const auto message = receive())
      if (message->payload.find(part) != std::string::npos) return message->payload;
    return {};
  }
  /// Returns the next binary message whose first byte is `op`, without that byte.
  std::string receive_binary(char op) {
    while (const auto message = receive())
      if (message->opcode == 2 && message->payload[0] == op) return message->payload.substr(1);
    return {};
  }
  /// Waits until the server has read everything sent before.
  /// @return its messages meanwhile
  std::string settle() {
    text(R"({"op":"getParameters","parameterNames":[],"id":"settle"})");
    std::string texts;
    while (const auto message = receive()) {
      if (message->payload.find("settle") != std::string::npos) return texts;
      if (message->opcode == 1) texts += message->payload;
    }
    return texts;
  }

 private:
  std::string read(std::size_t size) {
    std::string bytes(size, '\0');
    std::size_t at = 0;
    while (at < size) {
      const auto got = ::recv(socket_, bytes.data() + at, size - at, 0);
      if (got <= 0) break;
      at += static_cast<std::size_t>(got);
    }
    bytes.resize(at);
    return bytes;
  }

  int socket_;
  std::uint16_t port_;
  bool connected_ = false;
  std::string head_;
};

}  // namespace sf::bridges
