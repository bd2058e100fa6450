#include "bridges/web_server.h"

#include <fmt/format.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <deque>
#include <thread>

#include "base/error.h"

namespace sf::bridges {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Error = beast::error_code;

constexpr std::size_t kMaxHeader = 16 << 10;                   // [byte]
constexpr auto kAcceptPause = std::chrono::milliseconds(200);  // after a connection could not be accepted
constexpr auto kRequestTime = std::chrono::seconds(15);
constexpr auto kSilence = std::chrono::seconds(60);  // maximum time without a message or an answer to a ping
// [byte] Data in the kernel's buffer can no longer be dropped: a second's data of a large fleet would be too much.
constexpr int kSendBuffer = 256 << 10;

using Request = http::request<http::empty_body>;
using Response = http::response<http::string_body>;

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

/// Returns the first offered sub-protocol that is known; empty: none.
std::string choose_protocol(const Request& request, const std::vector<std::string>& known) {
  for (const auto& offered : http::token_list(request[http::field::sec_websocket_protocol]))
    for (const std::string& protocol : known)
      if (offered == beast::string_view(protocol)) return protocol;
  return {};
}

Response answer(const Request& request, http::status status, std::string_view type, std::string_view body) {
  Response response(status, request.version());
  response.set(http::field::content_type, beast::string_view(type.data(), type.size()));
  response.set(http::field::cache_control, "no-store");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Content-Security-Policy",
               "default-src 'self'; connect-src 'self' ws: wss:; img-src 'self' data: blob: http: https:; "
               "media-src 'self' blob: http: https:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'");
  response.keep_alive(request.keep_alive());
  response.body().assign(body.data(), request.method() == http::verb::head ? 0 : body.size());
  response.prepare_payload();
  return response;
}

Response refusal(const Request& request, http::status status, const std::string& why) {
  return answer(request, status, "text/plain; charset=utf-8", why + "\n");
}

}  // namespace

class Connection;

class WebServer::Implementation {
 public:
  Implementation(WebServer& server, WebOptions options, WebApplication& application);
  ~Implementation();

  std::uint16_t listen();
  void start();
  void post(std::function<void()> function) { asio::post(context_, std::move(function)); }
  Connection* find(ClientId client);

  ClientId add(Connection& connection);
  void remove(ClientId client) { clients_.erase(client); }
  void left() { --connections_; }
  bool is_full() const { return clients_.size() >= options.limits.clients; }
  void skip() { ++server_.skipped_; }
  /// Returns why a request is refused; empty: accepted.
  std::string refuse(const Request& request, bool needs_token) const;

  WebOptions options;  ///< only the server's thread changes them
  WebApplication& application;

 private:
  void accept();
  void accept_later();

  WebServer& server_;
  std::size_t connections_ = 0;
  ClientId next_client_ = 1;
  std::map<ClientId, Connection*> clients_;
  asio::io_context context_{1};  // destroyed after everything that its connections use
  tcp::acceptor acceptor_{context_};
  asio::steady_timer pause_{context_};
  std::thread thread_;
};

/// One connection: requests for files, then possibly a WebSocket.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, WebServer::Implementation& server) : server_(server), socket_(std::move(socket)) {}
  ~Connection();

  void read_request();
  void reply(WebMessage message);
  void update(std::vector<WebMessage> messages);

 private:
  void received_request(Error error);
  void respond(Response response);
  Response file(const Request& request) const;
  void open(const Request& request);
  void opened(Error error);
  void read_message();
  void received_message(Error error);
  void send_next();
  void drop_old_updates();
  void end();

  WebServer::Implementation& server_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer buffer_;
  std::unique_ptr<http::request_parser<http::empty_body>> parser_;
  std::unique_ptr<Response> response_;
  std::string protocol_;
  ClientId client_ = 0;  ///< 0: not a WebSocket
  bool ended_ = false;

  std::deque<WebMessage> replies_;
  std::size_t reply_bytes_ = 0;  ///< counted bytes in `replies_`
  std::deque<std::vector<WebMessage>> updates_;
  std::vector<WebMessage> current_;  ///< update being sent
  std::size_t next_ = 0;             ///< index in `current_`
  bool sending_ = false;
  WebMessage sent_;  ///< being sent
};

WebServer::Implementation::Implementation(WebServer& server, WebOptions web_options, WebApplication& web_application)
    : options(std::move(web_options)), application(web_application), server_(server) {}

WebServer::Implementation::~Implementation() {
  context_.stop();
  if (thread_.joinable()) thread_.join();
}

std::uint16_t WebServer::Implementation::listen() {
  const tcp::endpoint endpoint(asio::ip::make_address(options.address.host), options.address.port);
  Error error;
  acceptor_.open(endpoint.protocol(), error);
  if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor_.bind(endpoint, error);
  if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
  if (error)
    throw base::InputError(
        fmt::format("cannot listen on {}:{} (TCP): {}; give another address or port, or port 0 for "
                    "any free one",
                    options.address.host, options.address.port, error.message()));
  return acceptor_.local_endpoint().port();
}

void WebServer::Implementation::start() {
  accept();
  thread_ = std::thread([this] { context_.run(); });
}

void WebServer::Implementation::accept() {
  acceptor_.async_accept([this](Error error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (error) return accept_later();
    if (connections_ < options.limits.connections) {
      ++connections_;
      std::make_shared<Connection>(std::move(socket), *this)->read_request();
    }
    accept();
  });
}

/// Without free descriptors, the connection remains pending and each attempt would fail immediately.
void WebServer::Implementation::accept_later() {
  pause_.expires_after(kAcceptPause);
  pause_.async_wait([this](Error error) {
    if (!error) accept();
  });
}

Connection* WebServer::Implementation::find(ClientId client) {
  const auto found = clients_.find(client);
  return found == clients_.end() ? nullptr : found->second;
}

ClientId WebServer::Implementation::add(Connection& connection) {
  clients_[next_client_] = &connection;
  return next_client_++;
}

std::string WebServer::Implementation::refuse(const Request& request, bool needs_token) const {
  const bool has_token = same_token(query_value(view(request.target()), "token"), server_.token_);
  if (has_token) return {};
  const std::string_view host = view(request[http::field::host]);
  if (!is_loopback(options.address.host))
    return needs_token ? "The token is missing: use the complete URL that sensorfarm printed." : "";
  if (!is_own_name(host)) return "This host name is not accepted: use http://localhost or 127.0.0.1.";
  if (needs_token && !is_known_origin(view(request[http::field::origin]), host))
    return fmt::format("Pages of {} cannot connect without the token.", view(request[http::field::origin]));
  return {};
}

Connection::~Connection() {
  if (client_ != 0 && !ended_) server_.remove(client_);
  server_.left();
}

void Connection::read_request() {
  beast::get_lowest_layer(socket_).expires_after(kRequestTime);
  parser_ = std::make_unique<http::request_parser<http::empty_body>>();
  parser_->header_limit(kMaxHeader);
  http::async_read(socket_.next_layer(), buffer_, *parser_,
                   [self = shared_from_this()](Error error, std::size_t) { self->received_request(error); });
}

void Connection::received_request(Error error) {
  if (error) return end();
  const Request& request = parser_->get();
  if (websocket::is_upgrade(request)) return open(request);
  if (request.method() != http::verb::get && request.method() != http::verb::head)
    return respond(refusal(request, http::status::method_not_allowed, "Only GET and HEAD are supported."));
  respond(file(request));
}

Response Connection::file(const Request& request) const {
  const std::string_view target = view(request.target());
  const auto found = server_.options.files.find(std::string(target.substr(0, target.find('?'))));
  if (found == server_.options.files.end())
    return refusal(request, http::status::not_found, "No such file; the view is at /.");
  const std::string why = server_.refuse(request, found->second.is_private);
  if (!why.empty()) return refusal(request, http::status::forbidden, why);
  return answer(request, http::status::ok, found->second.type, found->second.text);
}

void Connection::respond(Response response) {
  response_ = std::make_unique<Response>(std::move(response));
  http::async_write(socket_.next_layer(), *response_, [self = shared_from_this()](Error error, std::size_t) {
    if (error || !self->response_->keep_alive()) return self->end();
    self->read_request();
  });
}

void Connection::open(const Request& request) {
  const std::string why = server_.refuse(request, true);
  if (!why.empty()) return respond(refusal(request, http::status::forbidden, why));
  if (server_.is_full())
    return respond(refusal(request, http::status::service_unavailable,
                           fmt::format("{} viewers are already connected.", server_.options.limits.clients)));
  protocol_ = choose_protocol(request, server_.options.protocols);
  if (protocol_.empty())
    return respond(
        refusal(request, http::status::bad_request,
                fmt::format("Offer one of the sub-protocols {}.", fmt::join(server_.options.protocols, " and "))));
  beast::get_lowest_layer(socket_).expires_never();
  Error ignored;
  beast::get_lowest_layer(socket_).socket().set_option(tcp::no_delay(true), ignored);
  beast::get_lowest_layer(socket_).socket().set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
  socket_.set_option(websocket::stream_base::timeout{kRequestTime, kSilence, true});
  socket_.set_option(websocket::stream_base::decorator(
      [this](websocket::response_type& response) { response.set(http::field::sec_websocket_protocol, protocol_); }));
  socket_.read_message_max(server_.options.limits.message);
  socket_.auto_fragment(false);
  socket_.async_accept(request, [self = shared_from_this()](Error error) { self->opened(error); });
}

void Connection::opened(Error error) {
  if (error) return end();
  parser_.reset();
  buffer_.clear();
  client_ = server_.add(*this);
  server_.application.opened(client_, protocol_);
  read_message();
}

void Connection::read_message() {
  if (ended_) return;
  socket_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) { self->received_message(error); });
}

void Connection::received_message(Error error) {
  if (error || ended_) return end();
  const auto bytes = buffer_.data();
  server_.application.received(client_, socket_.got_text(),
                               {static_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  buffer_.clear();
  read_message();
}

void Connection::reply(WebMessage message) {
  if (ended_) return;
  if (!message.is_lasting) reply_bytes_ += message.size() + sizeof(message);
  replies_.push_back(std::move(message));
  if (reply_bytes_ > server_.options.limits.replies) return end();
  send_next();
}

void Connection::update(std::vector<WebMessage> messages) {
  if (ended_ || messages.empty()) return;
  updates_.push_back(std::move(messages));
  drop_old_updates();
  send_next();
}

void Connection::drop_old_updates() {
  std::size_t bytes = 0;
  for (const auto& update : updates_)
    for (const WebMessage& message : update) bytes += message.size() + sizeof(message);
  const WebLimits& limits = server_.options.limits;
  while (updates_.size() > 1 && (updates_.size() > limits.waiting_updates || bytes > limits.waiting_bytes)) {
    for (const WebMessage& message : updates_.front()) bytes -= message.size() + sizeof(message);
    updates_.pop_front();
    server_.skip();
  }
}

/// Sends replies first, then the rest of the current update.
void Connection::send_next() {
  if (sending_ || ended_) return;
  if (!replies_.empty()) {
    sent_ = std::move(replies_.front());
    replies_.pop_front();
    if (!sent_.is_lasting) reply_bytes_ -= sent_.size() + sizeof(sent_);
  } else {
    if (next_ >= current_.size()) {
      if (updates_.empty()) return;
      current_ = std::move(updates_.front());
      updates_.pop_front();
      next_ = 0;
    }
    sent_ = std::move(current_[next_++]);
  }
  sending_ = true;
  socket_.text(sent_.is_text);
  const std::array<asio::const_buffer, 2> parts{
      asio::const_buffer(sent_.head.data(), sent_.head_size),
      sent_.body ? asio::const_buffer(sent_.body->data(), sent_.body->size()) : asio::const_buffer()};
  socket_.async_write(parts, [self = shared_from_this()](Error error, std::size_t) {
    self->sending_ = false;
    self->sent_ = {};
    if (error) return self->end();
    self->send_next();
  });
}

/// Closes without a handshake: pending data is useless, and a client that does not read would not answer.
void Connection::end() {
  if (ended_) return;
  ended_ = true;
  Error ignored;
  beast::get_lowest_layer(socket_).socket().close(ignored);
  if (client_ == 0) return;
  server_.remove(client_);
  // Post it: the application may be processing a message of that client.
  server_.post([&application = server_.application, client = client_] { application.closed(client); });
}

WebServer::WebServer(WebOptions options, WebApplication& application)
    : token_(random_token()),
      address_(options.address),
      implementation_(std::make_unique<Implementation>(*this, std::move(options), application)) {
  port_ = implementation_->listen();
  implementation_->start();
}

WebServer::~WebServer() = default;

std::string WebServer::url() const {
  const std::string query = is_loopback(address_.host) ? "" : "?token=" + token_;
  return fmt::format("http://{}:{}/{}", address_.host, port_, query);
}

void WebServer::post(std::function<void()> function) { implementation_->post(std::move(function)); }

void WebServer::set_file(const std::string& path, std::string_view text) {
  implementation_->options.files.at(path).text = text;
}

void WebServer::reply(ClientId client, WebMessage message) {
  if (Connection* const connection = implementation_->find(client)) connection->reply(std::move(message));
}

void WebServer::update(ClientId client, std::vector<WebMessage> messages) {
  if (Connection* const connection = implementation_->find(client)) connection->update(std::move(messages));
}

}  // namespace sf::bridges
