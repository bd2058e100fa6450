#pragma once
// The live view: a page in the browser, and Foxglove's own viewers, over one socket.
//
//   Viewer viewer(scene, {.address = {"127.0.0.1", 8765}});
//   puts(viewer.describe());   // view on http://127.0.0.1:8765/
//
// The run's thread encodes messages of subscribed topics, each at most 40 times a second of real time, images 16
// times and at most 5 MB/s. The server's thread does the rest.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bridges/bridge.h"
#include "bridges/last_tick.h"
#include "bridges/view_clouds.h"
#include "bridges/view_intents.h"
#include "bridges/viewer_sessions.h"
#include "bridges/web_server.h"
#include "record/topics.h"

namespace sf::bridges {

struct ViewerOptions {
  WebAddress address;
  ViewerMode mode = ViewerMode::run;
  std::int64_t start = 0, end = 0;  ///< [ns] of a recording
  WebLimits limits;
};

class Viewer : public Bridge {
 public:
  /// @throws base::InputError if the address is unavailable
  Viewer(const Scene& scene, const ViewerOptions& options);
  ~Viewer() override;

  void show_intents(std::span<const base::Intent> intents) override { intents_.take(intents); }
  void publish(const base::TickRecord& tick, const RunState& state) override;
  void publish(const RunState& state) override;
  /// Delays a pause by one tick, whose readings are all kept for users who select robots meanwhile.
  void take(Requests& requests) override;
  std::string describe() const override;

  const WebServer& server() const { return *server_; }
  /// Returns the number of updates sent to no client because the server's thread was behind.
  std::uint64_t dropped() const { return dropped_; }

 private:
  using Clock = std::chrono::steady_clock;

  void show(const RunState& state);
  void show_shapes();
  void choose_topics(bool all);
  void send(const base::TickRecord& tick);
  void keep_clouds(const base::TickRecord& tick);
  std::shared_ptr<const base::Bytes> copy_of(std::span<const std::uint8_t> message);

  const Scene scene_;
  record::TickMessages messages_;
  std::string scene_json_;
  const ViewerMode mode_;
  ViewerWishes wishes_;
  ViewerSessions sessions_;
  LastTick last_;
  RunState state_;
  bool shown_ = false;
  Clock::time_point next_state_, next_time_;
  std::uint32_t fleet_;        ///< topic of the states
  std::uint32_t cloud_topic_;  ///< of `clouds_`; those of the solids and of `intents_` follow
  ViewClouds clouds_;
  ViewIntents intents_;
  base::Bytes cloud_message_, intent_message_;
  std::vector<std::uint32_t> topics_, fresh_, due_;  ///< `due_`: topics to send, including `fresh_`
  std::vector<bool> wanted_;
  std::vector<bool> is_image_;                         ///< per topic: CompressedImage, sent at a lower rate
  std::vector<Clock::time_point> next_;                ///< per topic: earliest time of its next message
  std::vector<std::shared_ptr<base::Bytes>> buffers_;  ///< of large messages, reused
  Requests requests_;
  bool pausing_ = false;          ///< whether a pause waits for a tick
  bool is_kept_ = false;          ///< whether `last_` has the readings of the newest tick
  bool paused_shown_ = false;     ///< whether the last tick before the pause was sent
  std::atomic<int> waiting_ = 0;  ///< updates queued for the server's thread
  std::uint64_t dropped_ = 0;
  std::unique_ptr<WebServer> server_;  ///< last member: its thread uses the others
};

}  // namespace sf::bridges
