#pragma once
// Clients of Foxglove's protocol: what each client received, subscribed to and requested. Runs on the server's thread,
// except `ViewerWishes`.

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "bridges/bridge.h"
#include "bridges/foxglove_bytes.h"
#include "bridges/foxglove_messages.h"
#include "bridges/web_server.h"
#include "record/topics.h"

namespace sf::bridges {

/// How the time of a bridge's scene advances, and what its users may change.
enum class ViewerMode {
  run,       ///< pause, speed, steps, reset; robots take commands
  service,   ///< nothing
  recording  ///< pause, speed, steps, and any time of the recording
};

/// The requests of all clients, shared by the server's thread and the run's thread. No function blocks.
class ViewerWishes {
 public:
  explicit ViewerWishes(std::size_t topics) : subscribers_(topics, 0) {}

  void subscribe(std::uint32_t topic, bool on);
  /// Appends the topics with subscribers to `all`, and the topics with new subscribers since the last call to `fresh`.
  void topics(std::vector<std::uint32_t>& all, std::vector<std::uint32_t>& fresh);

  void command(const Command& command);  ///< replaces an earlier command to the same mover
  void pause(bool paused);
  void step();
  void speed(double speed);
  void reset();
  void seek(std::int64_t time);
  /// Moves all requests to the end of `requests`.
  void take(Requests& requests);

 private:
  std::mutex mutex_;
  std::vector<std::uint32_t> subscribers_;  ///< per topic
  std::set<std::uint32_t> subscribed_, fresh_;
  Requests requests_;
};

/// One message of a topic, shared by all of its subscribers.
struct SharedMessage {
  std::uint32_t topic = 0;
  std::int64_t time = 0;  ///< [ns]
  std::shared_ptr<const base::Bytes> bytes;
};

class ViewerSessions : public WebApplication {
 public:
  struct About {
    std::string name;
    ViewerMode mode = ViewerMode::run;
    std::int64_t start = 0, end = 0;   ///< [ns] of a recording
    std::vector<std::string> drivers;  ///< command topics by mover; empty: none
  };
  ViewerSessions(About about, std::span<const record::Topic> topics, ViewerWishes& wishes);

  /// Called once, before the first client.
  /// @param latched messages, at most one per topic
  void start(WebServer& server, std::vector<SharedMessage> latched);

  /// Called once, before the first client: the first subscriber of `topic` has its only message made, on the server's
  /// thread, and all get it.
  void provide(std::uint32_t topic, std::function<base::Bytes()> make) { makers_[topic] = std::move(make); }

  void opened(ClientId client, const std::string& protocol) override;
  void received(ClientId client, bool is_text, std::span<const std::uint8_t> bytes) override;
  void closed(ClientId client) override;

  bool empty() const { return count_ == 0; }  ///< thread-safe

  /// Sends one update to all clients: their subscribed topics of `messages`, and the time.
  void update(std::int64_t time, const std::vector<SharedMessage>& messages);
  /// Sends changes of the run's state to clients.
  /// @param time [ns]
  void show(const RunState& state, std::int64_t time);
  /// Tells clients that shapes of movers have changed: `/scene.json` is new.
  void show_shapes();

 private:
  struct Client {
    bool is_sdk = false;
    std::unordered_map<std::uint32_t, std::uint32_t> subscription_of;  ///< by topic
    std::unordered_map<std::uint32_t, std::uint32_t> topic_of;         ///< by subscription
    std::map<std::uint32_t, ClientText::Advertised> channels;          ///< published by the client, by id
    std::set<std::string> watched;                                     ///< parameters
  };

  void received_text(ClientId id, Client& client, std::string_view text);
  void subscribe(ClientId id, Client& client, const ClientText::Subscription& subscription);
  void unsubscribe(Client& client, std::uint32_t subscription);
  void advertise(ClientId id, Client& client, const ClientText::Advertised& channel);
  void published(ClientId id, const Client& client, const ClientPublish& publish);
  void call(ClientId id, const ServiceCall& call);
  void play(ClientId id, const PlaybackRequest& request);
  std::string set(const Parameter& parameter);
  void watch(Client& client, const ClientText& message);
  std::vector<Parameter> parameters(const std::vector<std::string>& names) const;

  void send(ClientId id, std::string text);
  void send(ClientId id, base::Bytes bytes);
  void complain(ClientId id, const std::string& what);
  bool is_controlled() const { return about_.mode != ViewerMode::service; }
  PlaybackState playback() const;
  void send_changed(ClientId id, const Client& client, const std::vector<std::string>& changed);

  const About about_;
  ViewerWishes& wishes_;
  WebServer* server_ = nullptr;
  std::vector<std::shared_ptr<const base::Bytes>> greetings_;  ///< channels and services
  std::size_t topic_count_ = 0;
  std::unordered_map<std::uint32_t, SharedMessage> latched_;
  std::unordered_map<std::uint32_t, std::function<base::Bytes()>> makers_;  ///< of `provide`, those not yet called
  std::unordered_map<std::string, std::uint32_t> movers_;                   ///< by command topic
  std::string session_;
  std::map<ClientId, Client> clients_;
  std::atomic<std::size_t> count_ = 0;  ///< of clients
  RunState state_;
  std::uint32_t shapes_ = 0;  ///< number of changes of shapes
  std::int64_t time_ = 0;
};

}  // namespace sf::bridges
