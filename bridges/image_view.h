#pragma once
// The live view of cameras, or of other sources of pictures: a page in the browser with the newest image of each and a
// table of tags, and Foxglove's own viewers, over one socket.
//
//   ImageView view("lab.toml", {"north", "south"}, {.address = {"127.0.0.1", 8765}});
//   if (const auto cameras = view.wanted()) view.publish(time, pictures_of(*cameras), tags);
//
// A slow browser loses images and never delays the caller.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/pose.h"
#include "bridges/viewer_sessions.h"
#include "bridges/web_server.h"
#include "record/topics.h"

namespace sf::bridges {

struct ImageViewOptions {
  WebAddress address;
  /// Of images, only the newest update waits for a client.
  WebLimits limits = {.waiting_updates = 1};
  double interval = 1.0 / 16.0;  ///< [s] least real time between two updates; 15 images/s pass
  bool tags = true;              ///< whether there is a topic of tags
  const char* format = "jpeg";   ///< or "png"
};

struct CameraPicture {
  std::size_t camera = 0;  ///< row of the cameras
  base::Bytes bytes;       ///< in the view's format
};

/// A tag that cameras see.
struct SeenTag {
  std::uint32_t id = 0;
  base::Pose X_WT;
  base::Twist velocity;       ///< in the tag's frame
  std::uint32_t cameras = 0;  ///< number of cameras that see it
};

/// All functions are for one thread.
class ImageView {
 public:
  /// @param cameras names, as in topics
  /// @throws base::InputError if the address is unavailable
  ImageView(const std::string& name, std::span<const std::string> cameras, const ImageViewOptions& options);
  ~ImageView();

  /// Returns the cameras (rows) whose pictures are to be published now; nullopt: there are no clients, or the last
  /// update was too recent. Updates pause for twice the time from `wanted` to the end of `publish` or longer, so
  /// drawing takes at most a third of the caller's time.
  std::optional<std::vector<std::size_t>> wanted();
  /// Sends one update: tags, and pictures of the wanted cameras. @param time [ns] >= 0
  void publish(std::int64_t time, std::vector<CameraPicture> pictures, std::span<const SeenTag> tags);

  /// Returns "view on http://127.0.0.1:8765/".
  std::string describe() const { return "view on " + server_->url(); }
  const WebServer& server() const { return *server_; }

 private:
  using Clock = std::chrono::steady_clock;

  std::vector<std::string> cameras_;
  const std::string format_;
  std::vector<record::Topic> topics_;  ///< one per camera, then tags
  ViewerWishes wishes_;
  ViewerSessions sessions_;
  std::vector<std::uint32_t> subscribed_, fresh_;
  const Clock::duration interval_;
  Clock::time_point next_, asked_;
  std::atomic<int> waiting_ = 0;       ///< updates queued for the server's thread
  std::unique_ptr<WebServer> server_;  ///< last member: its thread uses the others
};

}  // namespace sf::bridges
