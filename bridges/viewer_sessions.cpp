#include "bridges/viewer_sessions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bridges/web_access.h"
#include "record/cdr.h"

namespace sf::bridges {

namespace {

constexpr std::size_t kChannelsPerMessage = 256;
constexpr std::size_t kMostOwnChannels = 4096;  // maximum number of channels that a client publishes

constexpr const char* kPaused = "/paused";
constexpr const char* kSpeed = "/speed";  // 0: as fast as the machine allows
constexpr const char* kMeasured = "/measured_speed";
constexpr const char* kRuns = "/runs";
constexpr const char* kShapes = "/shapes";  // only if shapes have changed
const std::vector<std::string> kParameters{kPaused, kSpeed, kMeasured, kRuns, kShapes};

enum ServiceId : std::uint32_t { kPause = 1, kStep, kReset };
constexpr const char* kResponse = "bool success\nstring message\n";
const std::array<Service, 3> kServices{{{kPause, "/pause", "std_srvs/srv/SetBool", "bool data\n", kResponse},
                                        {kStep, "/step", "std_srvs/srv/Trigger", "", kResponse},
                                        {kReset, "/reset", "std_srvs/srv/Trigger", "", kResponse}}};

std::string_view payload_text(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::shared_ptr<const base::Bytes> bytes_of(const std::string& text) {
  return std::make_shared<const base::Bytes>(text.begin(), text.end());
}

enum class TwistType { none, plain, stamped };

TwistType twist_type(std::string_view type) {
  if (type == "geometry_msgs/msg/Twist" || type == "geometry_msgs/Twist") return TwistType::plain;
  if (type == "geometry_msgs/msg/TwistStamped" || type == "geometry_msgs/TwistStamped") return TwistType::stamped;
  return TwistType::none;
}

base::Bytes cdr_response(bool success, std::string_view message) {
  base::Bytes bytes;
  record::CdrWriter cdr(bytes);
  cdr.put(success);
  cdr.put(message);
  return bytes;
}

std::optional<bool> read_bool(const ServiceCall& call) {
  if (call.encoding == "json") return parse_json_bool(payload_text(call.payload));
  record::CdrReader cdr(call.payload);
  const bool value = cdr.get<bool>();
  return cdr.good() ? std::optional(value) : std::nullopt;
}

double shown_speed(double speed) { return std::isfinite(speed) ? speed : 0.0; }
double real_speed(double shown) { return shown == 0.0 ? std::numeric_limits<double>::infinity() : shown; }

}  // namespace

ViewerSessions::ViewerSessions(About about, std::span<const record::Topic> topics, ViewerWishes& wishes)
    : about_(std::move(about)),
      wishes_(wishes),
      topic_count_(topics.size()),
      session_(random_token()),
      time_(about_.start) {
  std::vector<Channel> channels;
  for (std::uint32_t row = 0; row < topics.size(); ++row) {
    channels.push_back({row, topics[row].name, std::string(topics[row].type), std::string(topics[row].schema)});
    if (channels.size() < kChannelsPerMessage && row + 1 < topics.size()) continue;
    greetings_.push_back(bytes_of(advertise_text(channels)));
    channels.clear();
  }
  if (is_controlled()) greetings_.push_back(bytes_of(advertise_services_text(kServices)));
  for (std::uint32_t mover = 0; mover < about_.drivers.size(); ++mover) movers_[about_.drivers[mover]] = mover;
}

void ViewerSessions::start(WebServer& server, std::vector<SharedMessage> latched) {
  server_ = &server;
  for (SharedMessage& message : latched) latched_[message.topic] = std::move(message);
}

void ViewerSessions::send(ClientId id, std::string text) {
  server_->reply(id, {.is_text = true, .body = bytes_of(text)});
}

void ViewerSessions::send(ClientId id, base::Bytes bytes) {
  server_->reply(id, {.body = std::make_shared<const base::Bytes>(std::move(bytes))});
}

void ViewerSessions::complain(ClientId id, const std::string& what) { send(id, status_text(StatusLevel::error, what)); }

void ViewerSessions::opened(ClientId id, const std::string& protocol) {
  Client& client = clients_[id];
  count_ = clients_.size();
  client.is_sdk = protocol == kSdkV1;
  ServerInfo info{about_.name, {"time", "parameters", "parametersSubscribe"}, session_, {}, {}, {}};
  if (is_controlled()) info.capabilities.emplace_back("services");
  if (!about_.drivers.empty()) info.capabilities.emplace_back("clientPublish");
  if (about_.mode == ViewerMode::recording && client.is_sdk) {
    info.capabilities.emplace_back("playbackControl");
    info.start = about_.start;
    info.end = about_.end;
  }
  send(id, server_info_text(info));
  for (const auto& text : greetings_) server_->reply(id, {.is_text = true, .body = text, .is_lasting = true});
  if (info.start) send(id, playback_state_bytes(playback()));
}

void ViewerSessions::closed(ClientId id) {
  const auto found = clients_.find(id);
  if (found == clients_.end()) return;
  for (const auto& [topic, subscription] : found->second.subscription_of) wishes_.subscribe(topic, false);
  clients_.erase(found);
  count_ = clients_.size();
}

void ViewerSessions::received(ClientId id, bool is_text, std::span<const std::uint8_t> bytes) {
  const auto found = clients_.find(id);
  if (found == clients_.end()) return;
  if (is_text) return received_text(id, found->second, payload_text(bytes));
  const std::optional<ClientBinary> message = parse_client_binary(bytes);
  if (!message) return complain(id, "This binary message is not part of the protocol.");
  if (const auto* const publish = std::get_if<ClientPublish>(&*message)) published(id, found->second, *publish);
  if (const auto* const service = std::get_if<ServiceCall>(&*message)) call(id, *service);
  if (const auto* const request = std::get_if<PlaybackRequest>(&*message)) play(id, *request);
}

void ViewerSessions::received_text(ClientId id, Client& client, std::string_view text) {
  const std::optional<ClientText> message = parse_client_text(text);
  if (!message) return complain(id, "This text message is not part of the protocol.");
  using Op = ClientText::Op;
  switch (message->op) {
    case Op::subscribe:
      for (const auto& subscription : message->subscriptions) subscribe(id, client, subscription);
      break;
    case Op::unsubscribe:
      for (const std::uint32_t subscription : message->ids) unsubscribe(client, subscription);
      break;
    case Op::advertise:
      for (const auto& channel : message->channels) advertise(id, client, channel);
      break;
    case Op::unadvertise:
      for (const std::uint32_t channel : message->ids) client.channels.erase(channel);
      break;
    case Op::get_parameters:
      send(id, parameters_text(parameters(message->names), message->id));
      break;
    case Op::set_parameters:
      for (const Parameter& parameter : message->parameters)
        if (const std::string why = set(parameter); !why.empty()) complain(id, why);
      if (!message->id.empty()) send(id, parameters_text(message->parameters, message->id));
      break;
    case Op::subscribe_parameters:
    case Op::unsubscribe_parameters:
      watch(client, *message);
      break;
    case Op::other:
      break;
  }
}

void ViewerSessions::subscribe(ClientId id, Client& client, const ClientText::Subscription& subscription) {
  if (subscription.channel >= topic_count_)
    return complain(id, fmt::format("There is no channel {}.", subscription.channel));
  if (client.topic_of.count(subscription.id) > 0 || client.subscription_of.count(subscription.channel) > 0)
    return complain(id, fmt::format("Subscription {} of channel {}: the subscription or the channel is already in use.",
                                    subscription.id, subscription.channel));
  client.topic_of[subscription.id] = subscription.channel;
  client.subscription_of[subscription.channel] = subscription.id;
  wishes_.subscribe(subscription.channel, true);
  if (const auto maker = makers_.find(subscription.channel); maker != makers_.end()) {
    latched_[subscription.channel] = {subscription.channel, about_.start,
                                      std::make_shared<const base::Bytes>(maker->second())};
    makers_.erase(maker);
  }
  const auto latched = latched_.find(subscription.channel);
  if (latched == latched_.end()) return;
  WebMessage message{.body = latched->second.bytes, .is_lasting = true};
  message.head = message_head(subscription.id, latched->second.time);
  message.head_size = static_cast<std::uint8_t>(message.head.size());
  server_->reply(id, std::move(message));
}

void ViewerSessions::unsubscribe(Client& client, std::uint32_t subscription) {
  const auto found = client.topic_of.find(subscription);
  if (found == client.topic_of.end()) return;
  wishes_.subscribe(found->second, false);
  client.subscription_of.erase(found->second);
  client.topic_of.erase(found);
}

void ViewerSessions::advertise(ClientId id, Client& client, const ClientText::Advertised& channel) {
  if (movers_.count(channel.topic) == 0)
    return complain(id, fmt::format("{} accepts no messages; robots accept /NAME/cmd_vel.", channel.topic));
  if (twist_type(channel.type) == TwistType::none || (channel.encoding != "cdr" && channel.encoding != "json"))
    return complain(id,
                    fmt::format("{}: expected geometry_msgs/msg/Twist or TwistStamped in cdr or json, not {} in {}.",
                                channel.topic, channel.type, channel.encoding));
  if (client.channels.size() >= kMostOwnChannels) return complain(id, "Too many channels.");
  client.channels[channel.id] = channel;
}

void ViewerSessions::published(ClientId id, const Client& client, const ClientPublish& publish) {
  const auto found = client.channels.find(publish.channel);
  if (found == client.channels.end())
    return complain(id, fmt::format("Channel {} was not advertised.", publish.channel));
  const ClientText::Advertised& channel = found->second;
  const std::optional<base::Twist> twist =
      channel.encoding == "json" ? parse_json_twist(payload_text(publish.payload))
                                 : read_cdr_twist(publish.payload, twist_type(channel.type) == TwistType::stamped);
  if (!twist || !std::isfinite(twist->forward) || !std::isfinite(twist->left) || !std::isfinite(twist->turn))
    return complain(id, fmt::format("{}: the message is not a finite {}.", channel.topic, channel.type));
  wishes_.command({movers_.at(channel.topic), *twist});
}

void ViewerSessions::call(ClientId id, const ServiceCall& request) {
  const auto fail = [&](const std::string& why) { send(id, service_failure_text(request.service, request.call, why)); };
  if (!is_controlled() || request.service < kPause || request.service > kReset)
    return fail(fmt::format("There is no service {}.", request.service));
  if (request.encoding != "cdr" && request.encoding != "json") return fail("Expected the encoding cdr or json.");
  if (request.service == kPause) {
    const std::optional<bool> paused = read_bool(request);
    if (!paused) return fail("Expected std_srvs/srv/SetBool_Request.");
    wishes_.pause(*paused);
  } else if (request.service == kStep) {
    wishes_.step();
  } else {
    wishes_.reset();
  }
  base::Bytes payload;
  if (request.encoding == "json") {
    const std::string text = json_response(true, "");
    payload.assign(text.begin(), text.end());
  } else {
    payload = cdr_response(true, "");
  }
  send(id, service_response_bytes(request.service, request.call, request.encoding, payload));
}

void ViewerSessions::play(ClientId id, const PlaybackRequest& request) {
  if (about_.mode != ViewerMode::recording) return complain(id, "This is not a recording.");
  if (!std::isfinite(request.speed) || request.speed <= 0.0F) return complain(id, "The speed must be above 0.");
  wishes_.pause(request.pause);
  wishes_.speed(request.speed);
  PlaybackState answer = playback();
  answer.status = request.pause ? PlaybackState::Status::paused : PlaybackState::Status::playing;
  answer.speed = request.speed;
  answer.request = request.id;
  if (request.time) {
    answer.time = std::clamp(*request.time, about_.start, about_.end);
    answer.did_seek = true;
    wishes_.seek(answer.time);
  }
  send(id, playback_state_bytes(answer));
}

/// Returns why a parameter cannot be set, or an empty string if it was set.
std::string ViewerSessions::set(const Parameter& parameter) {
  if (!is_controlled()) return parameter.name + " cannot be set: robots in other processes do not wait.";
  if (parameter.name == kPaused) {
    const bool* const paused = std::get_if<bool>(&parameter.value);
    if (paused == nullptr) return "Expected /paused true or false.";
    wishes_.pause(*paused);
    return {};
  }
  if (parameter.name == kSpeed) {
    const double* const speed = std::get_if<double>(&parameter.value);
    if (speed == nullptr || !std::isfinite(*speed) || *speed < 0.0)
      return "Expected /speed above 0 (ratio of simulated to real time), or 0: as fast as the machine allows.";
    wishes_.speed(real_speed(*speed));
    return {};
  }
  return parameter.name + " cannot be set; /paused and /speed can.";
}

void ViewerSessions::watch(Client& client, const ClientText& message) {
  const std::vector<std::string>& names = message.names.empty() ? kParameters : message.names;
  for (const std::string& name : names) {
    if (message.op == ClientText::Op::unsubscribe_parameters) client.watched.erase(name);
    // Unknown names are not stored, so clients cannot fill the memory with them.
    else if (std::find(kParameters.begin(), kParameters.end(), name) != kParameters.end())
      client.watched.insert(name);
  }
}

/// @param names empty: all
std::vector<Parameter> ViewerSessions::parameters(const std::vector<std::string>& names) const {
  std::vector<Parameter> found;
  for (const Parameter& parameter :
       {Parameter{kPaused, state_.paused}, Parameter{kSpeed, shown_speed(state_.speed)},
        Parameter{kMeasured, state_.measured}, Parameter{kRuns, static_cast<double>(state_.runs)}})
    if (names.empty() || std::find(names.begin(), names.end(), parameter.name) != names.end())
      found.push_back(parameter);
  if (shapes_ > 0 && (names.empty() || std::ranges::find(names, kShapes) != names.end()))
    found.push_back({kShapes, static_cast<double>(shapes_)});
  return found;
}

PlaybackState ViewerSessions::playback() const {
  using Status = PlaybackState::Status;
  PlaybackState state{.time = time_, .speed = static_cast<float>(shown_speed(state_.speed))};
  if (state_.paused) state.status = time_ >= about_.end ? Status::ended : Status::paused;
  return state;
}

void ViewerSessions::update(std::int64_t time, const std::vector<SharedMessage>& messages) {
  const auto clock = std::make_shared<const base::Bytes>(time_bytes(time));
  for (const auto& [id, client] : clients_) {
    std::vector<WebMessage> update{{.body = clock}};
    for (const SharedMessage& message : messages) {
      const auto found = client.subscription_of.find(message.topic);
      if (found == client.subscription_of.end()) continue;
      WebMessage& out = update.emplace_back();
      out.head = message_head(found->second, message.time);
      out.head_size = static_cast<std::uint8_t>(out.head.size());
      out.body = message.bytes;
    }
    server_->update(id, std::move(update));
  }
}

void ViewerSessions::show(const RunState& state, std::int64_t time) {
  const bool playback_changed = state.paused != state_.paused || state.speed != state_.speed;
  std::vector<std::string> changed;
  if (state.paused != state_.paused) changed.emplace_back(kPaused);
  if (state.speed != state_.speed) changed.emplace_back(kSpeed);
  if (state.measured != state_.measured) changed.emplace_back(kMeasured);
  if (state.runs != state_.runs) changed.emplace_back(kRuns);
  state_ = state;
  time_ = time;
  for (const auto& [id, client] : clients_) {
    send_changed(id, client, changed);
    if (playback_changed && client.is_sdk && about_.mode == ViewerMode::recording)
      send(id, playback_state_bytes(playback()));
  }
}

void ViewerSessions::send_changed(ClientId id, const Client& client, const std::vector<std::string>& changed) {
  std::vector<std::string> names;
  for (const std::string& name : changed)
    if (client.watched.count(name) > 0) names.push_back(name);
  if (!names.empty()) send(id, parameters_text(parameters(names), ""));
}

void ViewerSessions::show_shapes() {
  ++shapes_;
  for (const auto& [id, client] : clients_) send_changed(id, client, {kShapes});
}

}  // namespace sf::bridges
