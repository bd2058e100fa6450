#include "bridges/ros2_bridge.h"

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <shared_mutex>
#include <utility>

#include "base/error.h"
#include "bridges/ros_types.h"
#include "netio/open_sockets.h"
#include "record/cdr.h"
#include "record/schemas.h"

namespace sf::bridges {

namespace {

constexpr std::string_view kNode = "sensorfarm";
constexpr std::string_view kDiscovery = "rmw_dds_common/msg/ParticipantEntitiesInfo";
constexpr std::string_view kDiscoveryFields =
    "rmw_dds_common/Gid gid\nrmw_dds_common/NodeEntitiesInfo[] node_entities_info_seq\n";
constexpr int kDepth = 10, kTransformsDepth = 100;  // messages kept for slow readers

bool is_set(const char* variable, std::string_view value) {
  const char* const text = std::getenv(variable);
  return text != nullptr && value == text;
}

/// Numbered as in rmw_cyclonedds: the participant's prefix and a count. This shows a client which request reader and
/// reply writer belong to one service.
std::string service_id(DdsGuid guid, std::size_t number) {
  for (std::size_t i = 0; i < 4; ++i) guid[12 + i] = static_cast<std::uint8_t>((number + 1) >> (24 - 8 * i));
  std::string text = "serviceid=";
  for (std::size_t i = 0; i < guid.size(); ++i) text += fmt::format("{}{:x}", i == 0 ? "" : ".", guid[i]);
  return text + ";";
}

/// A participant to which readers and writers are added while another thread writes.
class GrowingParticipant : public DdsParticipant {
 public:
  explicit GrowingParticipant(std::unique_ptr<DdsParticipant> inner) : inner_(std::move(inner)) {}
  DdsGuid guid() const override { return inner_->guid(); }
  std::size_t add_writer(const DdsEndpoint& endpoint, DdsGuid& guid) override {
    const std::unique_lock lock(mutex_);
    return inner_->add_writer(endpoint, guid);
  }
  std::size_t add_reader(const DdsEndpoint& endpoint, DdsGuid& guid) override {
    const std::unique_lock lock(mutex_);
    return inner_->add_reader(endpoint, guid);
  }
  bool write(std::size_t writer, const base::Bytes& message) override {
    const std::shared_lock lock(mutex_);
    return inner_->write(writer, message);
  }
  std::size_t count_readers(std::size_t writer) const override {
    const std::shared_lock lock(mutex_);
    return inner_->count_readers(writer);
  }
  bool can_answer(std::size_t writer, std::size_t reader, std::uint64_t sender) const override {
    const std::shared_lock lock(mutex_);
    return inner_->can_answer(writer, reader, sender);
  }

 private:
  mutable std::shared_mutex mutex_;
  std::unique_ptr<DdsParticipant> inner_;
};

/// Request writers are reliable.
/// @param id prefix of its user data
DdsEndpoint request_reader(const ServiceType& service, const std::string& id) {
  const std::string type = std::string(service.type) + "_Request";
  return {.topic = "rq" + std::string(service.name) + "Request",
          .type = dds_type(type),
          .user_data = id + type_user_data(type, record::with_dependencies(service.request)),
          .depth = kDepth,
          .requests = true};
}

DdsEndpoint reply_writer(const ServiceType& service, const std::string& id) {
  const std::string type = std::string(service.type) + "_Response";
  return {.topic = "rr" + std::string(service.name) + "Reply",
          .type = dds_type(type),
          .user_data = id + type_user_data(type, record::with_dependencies(service.response)),
          .depth = kDepth};
}

}  // namespace

Ros2Options ros2_options(std::string domain) {
  const char* const variable = std::getenv("ROS_DOMAIN_ID");
  const bool is_variable = domain.empty() && variable != nullptr;
  if (is_variable) domain = variable;
  Ros2Options options;
  options.loopback = is_set("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST") || is_set("ROS_LOCALHOST_ONLY", "1");
  if (domain.empty()) return options;
  const char* const end = domain.data() + domain.size();
  const auto [last, error] = std::from_chars(domain.data(), end, options.domain);
  if (error != std::errc() || last != end || options.domain > kDdsMaxDomain)
    throw base::InputError(fmt::format("{} '{}': expected the number of a domain, 0 to {}",
                                       is_variable ? "ROS_DOMAIN_ID" : "--ros2", domain, kDdsMaxDomain));
  return options;
}

void DdsInbox::add(DdsMessage&& message) {
  const std::lock_guard lock(mutex_);
  if (messages_.size() >= kMaxMessages || bytes_ + message.bytes.size() > kMaxBytes) {
    ++left_out_;
    return;
  }
  bytes_ += message.bytes.size();
  messages_.push_back(std::move(message));
}

void DdsInbox::take(std::deque<DdsMessage>& out) {
  const std::lock_guard lock(mutex_);
  std::move(messages_.begin(), messages_.end(), std::back_inserter(out));
  messages_.clear();
  bytes_ = 0;
}

std::uint64_t DdsInbox::left_out() const {
  const std::lock_guard lock(mutex_);
  return left_out_;
}

void DdsLog::write(std::string_view line) {
  const std::lock_guard lock(mutex_);
  line = line.substr(0, line.find_last_not_of('\n') + 1);
  log_.write(fmt::format("DDS: {}", line),
             std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1));
}

Ros2Bridge::Ros2Bridge(const Ros2Options& options, const Scene& scene, const DdsLibrary& library,
                       OpenFastServices open_fast)
    : options_(options), scene_(scene), services_(scene), messages_(std::in_place, scene.info) {
  // Queue service requests separately from commands, which are handled in every tick.
  const auto receive = [this](DdsMessage&& message) {
    const bool is_request = message.reader < services_.types().size();
    (is_request ? requests_ : commands_).add(std::move(message));
  };
  try {
    const netio::OpenSockets before;
    participant_ = std::make_unique<GrowingParticipant>(
        library.open({options.domain, "enclave=/;", options.loopback, {}, receive, [this](std::string_view line) {
                        log_.write(line);
                      }}));
    const std::set<std::string> addresses = before.addresses();
    if (options.loopback) before.keep_new_ones_to_loopback();
    add_services();
    add_topics();
    add_commands();
    add_fast(open_fast, addresses);
    announce();
  } catch (const std::runtime_error& error) {
    throw base::InputError(fmt::format("--ros2: {}", error.what()));
  }
  messages_->begin([this](const record::TopicMessage& message) { add(message); });
  outbox_.emplace(*participant_);
  outbox_->add(batch_);
}

std::string Ros2Bridge::describe() const {
  return fmt::format("ROS 2: node /{} in domain {}{}{}", kNode, options_.domain,
                     options_.loopback ? ", on this machine" : "", why_no_fast_);
}

void Ros2Bridge::show_scene(bool is_new) {
  const record::TickMessages before = std::move(*messages_);  // only its counts are used
  messages_.emplace(scene_.info);
  try {
    add_topics();
    add_commands();
  } catch (const std::runtime_error& error) {
    throw base::InputError(fmt::format("--ros2: {}", error.what()));
  }
  announce();
  const auto emit = [this](const record::TopicMessage& message) { add(message); };
  is_new ? messages_->begin(emit) : messages_->go_on(before, time_, emit);
  outbox_->add(batch_);
  services_.show_scene(is_new);
}

void Ros2Bridge::add_topics() {
  writer_of_.clear();
  for (const record::Topic& topic : messages_->topics()) {
    const bool is_command = topic.type == record::kTwistStamped;  // its topic receives external commands
    const int depth = topic.latched ? 1 : topic.type == record::kTransforms ? kTransformsDepth : kDepth;
    const auto [known, is_new] = writer_of_topic_.try_emplace(topic.name, kNone);
    if (is_new && !is_command)
      known->second = add_writer("rt" + topic.name, topic.type, topic.schema, depth, topic.latched);
    writer_of_.push_back(known->second);
  }
  wanted_.assign(writer_of_.size(), false);
}

void Ros2Bridge::add_commands() {
  if (!scene_.simulated) return;
  const std::string plain = record::schema_text("geometry_msgs/msg/Twist");
  const std::string stamped = record::schema_text(record::kTwistStamped);
  for (std::size_t reader = services_.types().size(); reader < reader_of_.size(); ++reader)
    reader_of_[reader].mover = world::kNone;  // until a mover of this scene uses the topic
  for (std::uint32_t row = 0; row < scene_.info.movers.size(); ++row) {
    if (scene_.world.movers[row].is_tag) continue;  // tags are placed by packets
    const std::string topic = "rt" + scene_.info.movers[row].space + "/cmd_vel";
    const auto [known, is_new] = commands_of_.try_emplace(topic, reader_of_.size());
    if (is_new) {
      add_reader(topic, "geometry_msgs/msg/Twist", plain);
      add_reader(topic, record::kTwistStamped, stamped);
      reader_of_.push_back({row, false}), reader_of_.push_back({row, true});
    }
    for (const std::size_t reader : {known->second, known->second + 1}) reader_of_[reader].mover = row;
  }
}

void Ros2Bridge::add_services() {
  for (const ServiceType& service : services_.types()) {
    const std::string id = service_id(participant_->guid(), reply_writers_.size());
    participant_->add_reader(request_reader(service, id), readers_.emplace_back());
    reader_of_.emplace_back();
    reply_writers_.push_back(participant_->add_writer(reply_writer(service, id), writers_.emplace_back()));
  }
  if (!scene_.simulated) return;
  for (const ActionTopic& topic : StepsAction::kTopics)
    action_writers_.push_back(add_writer("rt" + std::string(topic.name), topic.type,
                                         record::with_dependencies(topic.fields), topic.latched ? 1 : kDepth,
                                         topic.latched));
}

/// Adds the same services again, for clients that the participant above ignores.
void Ros2Bridge::add_fast(OpenFastServices open, const std::set<std::string>& addresses) {
  FastOptions options;
  options.dds = {.domain = options_.domain,
                 .user_data = "enclave=/;",
                 .loopback = options_.loopback,
                 .addresses = addresses,
                 .receive = [this](DdsMessage&& message) { requests_.add(std::move(message)); },
                 .log = [this](std::string_view line) { log_.write(line); }};
  for (const ServiceType& service : services_.types())
    options.services.push_back({request_reader(service, {}), reply_writer(service, {})});
  try {
    if (!options_.loopback && addresses.empty()) throw std::runtime_error("Cyclone DDS uses no IPv4 address here");
    fast_ = open(options);
  } catch (const std::runtime_error& error) {
    why_no_fast_ = fmt::format("; services do not answer rmw_fastrtps clients: {}", error.what());
  }
}

/// Publishes the data behind `ros2 node list`: the participant's nodes and their readers and writers.
void Ros2Bridge::announce() {
  if (discovery_ == kNone) {
    discovery_ = add_writer("ros_discovery_info", kDiscovery, record::with_dependencies(kDiscoveryFields), 1, true);
    writers_.pop_back();  // belongs to the participant, not to the node
  }
  record::CdrWriter cdr(batch_.add(discovery_));
  const auto put = [&cdr](const DdsGuid& guid) {
    for (const std::uint8_t byte : guid) cdr.put(byte);
  };
  put(participant_->guid());
  cdr.put_count(1);
  cdr.put("/");
  cdr.put(kNode);
  for (const auto* guids : {&readers_, &writers_}) {
    cdr.put_count(guids->size());
    for (const DdsGuid& guid : *guids) put(guid);
  }
}

std::size_t Ros2Bridge::add_writer(const std::string& topic, std::string_view type, std::string_view definition,
                                   int depth, bool latched) {
  return participant_->add_writer({topic, dds_type(type), type_user_data(type, definition), depth, latched},
                                  writers_.emplace_back());
}

std::size_t Ros2Bridge::add_reader(const std::string& topic, std::string_view type, std::string_view definition) {
  // Accept commands from reliable and best-effort writers.
  return participant_->add_reader({.topic = topic,
                                   .type = dds_type(type),
                                   .user_data = type_user_data(type, definition),
                                   .depth = kDepth,
                                   .best_effort = true},
                                  readers_.emplace_back());
}

void Ros2Bridge::publish(const base::TickRecord& tick, const RunState& state) {
  const auto emit = [this](const record::TopicMessage& message) { add(message); };
  if (state.runs != runs_) messages_->begin(emit);
  runs_ = state.runs;
  time_ = tick.time;
  for (std::size_t row = 0; row < writer_of_.size(); ++row)
    wanted_[row] = writer_of_[row] != kNone && participant_->count_readers(writer_of_[row]) > 0;
  messages_->encode(tick, emit, wanted_);
  if (!batch_.messages().empty()) outbox_->add(batch_);
  services_.observe(&tick, state);
  send_answers();
}

void Ros2Bridge::add(const record::TopicMessage& message) {
  batch_.add(writer_of_[message.topic]).assign(message.bytes.begin(), message.bytes.end());
}

void Ros2Bridge::publish(const RunState& state) {
  services_.observe(nullptr, state);
  send_answers();
}

void Ros2Bridge::take(Requests& requests) {
  commands_.take(come_);
  for (; !come_.empty(); come_.pop_front())
    if (!take_command(come_.front(), requests)) ++malformed_;
  if (pending_.empty()) requests_.take(pending_);
  for (std::size_t count = 0; !pending_.empty() && count < kMaxRequests; ++count, pending_.pop_front()) {
    const DdsMessage& message = pending_.front();
    if (!services_.take(message.reader, message.bytes, message.sender, requests)) ++malformed_;
  }
  send_answers();
}

bool Ros2Bridge::take_command(const DdsMessage& message, Requests& requests) const {
  record::CdrReader cdr(message.bytes);
  std::int64_t time = 0;
  const Reader& reader = reader_of_[message.reader];
  if (reader.mover == world::kNone) return false;  // of an earlier world
  if (reader.stamped) record::get_header(cdr, time);
  Command command{.mover = reader.mover};
  command.twist.forward = cdr.get<double>();
  command.twist.left = cdr.get<double>();
  for (int i = 0; i < 3; ++i) cdr.get<double>();  // z velocity, and rotation about x and y
  command.twist.turn = cdr.get<double>();
  const base::Twist& twist = command.twist;
  if (!cdr.good() || !std::isfinite(twist.forward + twist.left + twist.turn)) return false;
  requests.commands.push_back(command);
  return true;
}

void Ros2Bridge::send_answers() {
  for (Answer& answer : services_.answers()) {
    const std::uint64_t writer = answer.caller.sender.writer;
    if (answer.caller.sender.fast)
      fast_->add(DdsReply{answer.service, answer.service, writer, std::move(answer.message)});
    else
      outbox_->add(DdsReply{reply_writers_[answer.service], answer.service, writer, std::move(answer.message)});
  }
  if (action_writers_.empty()) return;
  for (ActionMessage& message : services_.messages())
    batch_.add(action_writers_[message.topic]) = std::move(message.bytes);
  if (!batch_.messages().empty()) outbox_->add(batch_);
}

Ros2Bridge::Counts Ros2Bridge::counts() const {
  DdsOutbox::Counts sent = outbox_->counts();
  if (fast_) {
    const DdsOutbox::Counts more = fast_->counts();
    sent.written += more.written;
    sent.left_out += more.left_out;
  }
  return {sent, malformed_, commands_.left_out() + requests_.left_out()};
}

}  // namespace sf::bridges
