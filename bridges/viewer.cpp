#include "bridges/viewer.h"

#include <algorithm>

#include "bridges/scene_json.h"
#include "bridges/view_solids.h"
#include "bridges/web_files.h"
#include "record/schemas.h"

namespace sf::bridges {

namespace {

using std::chrono::milliseconds;

// Ticks at 30 Hz arrive about every 33 ms; none of them may be skipped.
constexpr milliseconds kLeastInterval(25);
constexpr milliseconds kStateInterval(500);  // of the measured speed
constexpr milliseconds kImageInterval(62);   // 15 images/s pass
constexpr double kImageBytes = 5e6;          // per second of one camera
constexpr int kMostWaiting = 4;
constexpr std::size_t kViewTopics = 3;  // clouds, solids and intents

std::vector<std::string> drivers_of(const Scene& scene, ViewerMode mode) {
  std::vector<std::string> topics;
  if (mode != ViewerMode::run || !scene.simulated) return topics;
  for (const record::MoverInfo& mover : scene.info.movers) topics.push_back(mover.space + "/cmd_vel");
  return topics;
}

std::uint32_t row_of(std::string_view name, std::span<const record::Topic> topics) {
  const auto found =
      std::find_if(topics.begin(), topics.end(), [&](const record::Topic& topic) { return topic.name == name; });
  return static_cast<std::uint32_t>(found - topics.begin());
}

/// The topics of messages, then those of the 3-D view and of the view over images.
std::vector<record::Topic> topics_of(const record::TickMessages& messages) {
  static const std::string clouds = record::schema_text(record::kClouds), solids = record::schema_text(record::kSolids),
                           intents = record::schema_text(record::kIntents);
  std::vector<record::Topic> topics = messages.topics();
  topics.push_back({std::string(kCloudsTopic), record::kClouds, clouds});
  topics.push_back({std::string(kSolidsTopic), record::kSolids, solids, true});
  topics.push_back({std::string(kIntentsTopic), record::kIntents, intents});
  return topics;
}

std::chrono::steady_clock::duration time_of_bytes(std::size_t bytes) {
  using std::chrono::steady_clock;
  return std::chrono::duration_cast<steady_clock::duration>(
      std::chrono::duration<double>(static_cast<double>(bytes) / kImageBytes));
}

}  // namespace

Viewer::Viewer(const Scene& scene, const ViewerOptions& options)
    : scene_(scene),
      messages_(scene.info),
      scene_json_(scene_json(scene, options.mode)),
      mode_(options.mode),
      wishes_(messages_.topics().size() + kViewTopics),
      sessions_({"sensorfarm: " + scene.info.world, options.mode, options.start, options.end,
                 drivers_of(scene, options.mode)},
                topics_of(messages_), wishes_),
      fleet_(row_of("/fleet", messages_.topics())),
      cloud_topic_(static_cast<std::uint32_t>(messages_.topics().size())),
      clouds_(scene),
      intents_(scene.world),
      wanted_(messages_.topics().size() + kViewTopics),
      next_(messages_.topics().size() + kViewTopics) {
  std::vector<SharedMessage> latched;
  messages_.begin([&](const record::TopicMessage& message) {
    latched.push_back({message.topic, message.log_time,
                       std::make_shared<const base::Bytes>(message.bytes.begin(), message.bytes.end())});
  });
  for (const record::Topic& topic : messages_.topics()) is_image_.push_back(topic.type == record::kCompressedImage);
  is_image_.resize(next_.size());
  WebOptions web{options.address, {kSdkV1, kWebSocketV1}, web_files(), options.limits};
  web.files["/scene.json"] = {"application/json", scene_json_, true};
  server_ = std::make_unique<WebServer>(std::move(web), sessions_);
  server_->post([this, latched = std::move(latched), headroom = headroom_of(scene.world)] {
    sessions_.start(*server_, latched);
    sessions_.provide(cloud_topic_ + 1, [this, headroom] { return solids_message(scene_.world, headroom); });
  });
}

Viewer::~Viewer() = default;

std::string Viewer::describe() const { return "view on " + server_->url(); }

void Viewer::publish(const base::TickRecord& tick, const RunState& state) {
  if (!last_.empty() && tick.time < last_.time()) messages_.begin([](const record::TopicMessage&) {});  // a new run
  if (!tick.shapes.empty()) show_shapes();
  const bool is_watched = !sessions_.empty();
  // Copying all readings of a large fleet in every tick would cost more than sending the displayed ones.
  is_kept_ = state.paused || pausing_ || (mode_ == ViewerMode::recording && is_watched);
  last_.store(tick, is_kept_);
  show(state);
  paused_shown_ = state.paused;
  if (!is_watched) return;
  choose_topics(state.paused);
  const base::TickRecord& shown = is_kept_ && !fresh_.empty() ? last_.record() : tick;
  keep_clouds(shown);
  if (!due_.empty() || Clock::now() >= next_time_) send(shown);
}

void Viewer::take(Requests& requests) {
  wishes_.take(requests_);
  const bool waits = requests_.paused.value_or(false) && !state_.paused && !is_kept_ && !last_.empty() &&
                     mode_ == ViewerMode::run && !sessions_.empty();
  pausing_ = waits;
  if (!waits) requests.add(requests_);
}

void Viewer::publish(const RunState& state) {
  show(state);
  if (sessions_.empty() || last_.empty()) return;
  choose_topics(!paused_shown_);  // ticks may have been skipped before the pause
  paused_shown_ = true;
  if (due_.empty()) return;
  keep_clouds(last_.record());
  send(last_.record());
}

/// Sensors are read in different ticks, of which clients get some only.
void Viewer::keep_clouds(const base::TickRecord& tick) {
  if (std::binary_search(topics_.begin(), topics_.end(), cloud_topic_)) clouds_.add(tick);
}

/// Between two ticks the world does not change, so this thread may read it.
void Viewer::show_shapes() {
  server_->post([this, text = scene_json(scene_, mode_)]() mutable {
    scene_json_ = std::move(text);
    server_->set_file("/scene.json", scene_json_);
    sessions_.show_shapes();
  });
}

void Viewer::show(const RunState& state) {
  const Clock::time_point now = Clock::now();
  RunState next = state;
  if (now < next_state_) next.measured = state_.measured;
  const bool changed = next.paused != state_.paused || next.speed != state_.speed || next.runs != state_.runs ||
                       next.measured != state_.measured;
  if (shown_ && !changed) return;
  if (next.measured != state_.measured) next_state_ = now + kStateInterval;
  shown_ = true;
  state_ = next;
  server_->post([this, next, time = last_.time()] { sessions_.show(next, time); });
}

/// Sends readings together with the states of the same tick, because they would otherwise be drawn at earlier poses of
/// their robots. Topics wait for the states, but at most one interval longer, because a rare reading occurs in one tick
/// only.
/// @param all sends all subscribed topics, whether or not they are due
void Viewer::choose_topics(bool all) {
  topics_.clear();
  fresh_.clear();
  due_.clear();
  wishes_.topics(topics_, fresh_);
  const Clock::time_point now = Clock::now();
  const bool waits = std::binary_search(topics_.begin(), topics_.end(), fleet_) && now < next_[fleet_];
  for (const std::uint32_t topic : topics_) {
    const Clock::time_point turn = next_[topic] + (waits && topic != fleet_ ? kLeastInterval : milliseconds(0));
    if (all || now >= turn || std::binary_search(fresh_.begin(), fresh_.end(), topic)) due_.push_back(topic);
  }
}

/// Sends the tick's time and its messages on the topics of `due_`.
void Viewer::send(const base::TickRecord& tick) {
  if (waiting_ >= kMostWaiting) {
    ++dropped_;
    return;
  }
  // A late tick does not delay the next one, which follows sooner.
  const Clock::time_point now = Clock::now();
  const auto next = [now](Clock::time_point last) { return std::max(last, now - kLeastInterval) + kLeastInterval; };
  next_time_ = next(next_time_);
  std::vector<SharedMessage> update;
  for (const std::uint32_t topic : due_) wanted_[topic] = true;
  const auto add = [&](const record::TopicMessage& message) {
    next_[message.topic] = is_image_[message.topic]
                               ? now + std::max(Clock::duration(kImageInterval), time_of_bytes(message.bytes.size()))
                               : next(next_[message.topic]);
    update.push_back({message.topic, message.log_time, copy_of(message.bytes)});
  };
  messages_.encode(tick, add, wanted_);
  if (wanted_[cloud_topic_]) {
    cloud_message_.clear();
    clouds_.encode(tick, cloud_message_);
    add({.topic = cloud_topic_, .log_time = tick.time, .time = tick.time, .bytes = cloud_message_});
  }
  if (const std::uint32_t topic = cloud_topic_ + 2; wanted_[topic]) {
    intent_message_.clear();
    intents_.encode(tick.time, intent_message_);
    add({.topic = topic, .log_time = tick.time, .time = tick.time, .bytes = intent_message_});
  }
  for (const std::uint32_t topic : due_) wanted_[topic] = false;
  ++waiting_;
  server_->post([this, time = tick.time, update = std::move(update)] {
    --waiting_;
    sessions_.update(time, update);
  });
}

/// Large messages reuse buffers that all clients have released: allocating memory costs more than filling it.
std::shared_ptr<const base::Bytes> Viewer::copy_of(std::span<const std::uint8_t> message) {
  constexpr std::size_t kLarge = 16 << 10, kMostBuffers = 8;
  if (message.size() < kLarge) return std::make_shared<const base::Bytes>(message.begin(), message.end());
  const auto is_free = [](const std::shared_ptr<base::Bytes>& buffer) { return buffer.use_count() == 1; };
  const auto free = std::find_if(buffers_.begin(), buffers_.end(), is_free);
  if (free == buffers_.end()) {
    auto made = std::make_shared<base::Bytes>(message.begin(), message.end());
    if (buffers_.size() < kMostBuffers) buffers_.push_back(made);
    return made;
  }
  std::atomic_thread_fence(std::memory_order_acquire);  // synchronises with the last reader, the server's thread
  (*free)->assign(message.begin(), message.end());
  return *free;
}

}  // namespace sf::bridges
