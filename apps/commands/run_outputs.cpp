#include "apps/commands/run_outputs.h"

#include <algorithm>
#include <utility>

#include "apps/commands/run_settings.h"
#include "base/elapsed.h"
#include "base/time.h"
#include "netio/address_token.h"
#include "netio/own_end.h"

namespace sf::apps {

using Clock = std::chrono::steady_clock;

RunOutputs::RunOutputs(const world::World& world, const sensors::SensorSet& sensor_set,
                       const std::optional<server::StreamLayout>& layout, const std::string& caster,
                       const RunOptions& options, const std::string& record, const record::RecordingPart& part,
                       const std::string& video)
    : world_(world),
      sensor_set_(sensor_set),
      settings_(run_settings(options, caster, options.record_readings)),
      no_return_filter_(sensor_set, options.no_return_inf),
      session_token_{netio::random_session(), 0},
      is_whole_(part.parts == 1),
      sent_movers_(world.movers.size()) {
  if (layout) {
    address_ = netio::resolve(options.send);
    netio::OutboxOptions outbox = server::outbox_options(sensor_set);
    outbox.bind = netio::own_end_for(address_);
    publisher_.emplace(world, sensor_set, *layout, netio::Outbox(outbox));
  }
  if (record.empty() && video.empty()) return;
  const record::RunInfo info = scenarios::run_info(world, sensor_set, settings_);
  VideoOptions shown = options;
  shown.video = video;
  if (!video.empty()) video_.emplace(world, info, shown);
  if (!record.empty()) recorder_.emplace(record, info, part);
}

std::vector<std::string> RunOutputs::taken_names() const {
  return recorder_ ? recorder_->taken_names() : std::vector<std::string>();
}

void RunOutputs::write(base::TickRecord tick, const std::function<void(std::int64_t)>& wait) {
  const auto start = Clock::now();
  if (!tick.shapes.empty()) update_bodies();
  tick.readings = no_return_filter_.apply(tick.readings);
  double waited = 0.0;
  std::int64_t sent_at = tick.time;
  for (const base::ReadingBlock& reading : publisher_ ? tick.readings : std::span<const base::ReadingBlock>{}) {
    const std::int64_t time =
        std::min<std::int64_t>(tick.time, reading.time + base::nanoseconds(sensor_set_.row(reading).latency));
    if (time != std::exchange(sent_at, time)) {
      send();
      const auto before = Clock::now();
      wait(time);
      waited += base::seconds_since(before);
    }
    if (reading.mover < sent_movers_) addressed_readings_.push_back({&reading, address_, session_token_});
  }
  if (publisher_) send();
  if (recorder_) recorder_->write(tick);
  if (video_) video_->write(tick);
  seconds_ += base::seconds_since(start) - waited;
}

void RunOutputs::add_movers(const std::vector<record::JoinedMover>& joined) {
  settings_.joined = joined;
  update_bodies();
}

void RunOutputs::update_bodies() {
  if (recorder_ && is_whole_) recorder_->add_movers(scenarios::run_info(world_, sensor_set_, settings_));
  if (video_) video_->add_movers(world_);
}

void RunOutputs::finish(RunReport& facts) {
  facts.out_s = seconds_;
  if (publisher_) {
    facts.sent = true;
    facts.publisher = publisher_->counts();
  }
  if (video_) facts.video = video_->finish();
  if (!recorder_) return;
  recorder_->finish();
  facts.recording = recorder_->path();
  facts.recorded_bytes = recorder_->size();
}

void RunOutputs::send() {
  publisher_->queue(addressed_readings_);
  publisher_->flush();
  addressed_readings_.clear();
}

}  // namespace sf::apps
