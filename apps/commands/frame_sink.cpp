#include "apps/commands/frame_sink.h"

#include <fmt/format.h>

#include <filesystem>

#include "apps/commands/numbered_files.h"
#include "apps/reports/text.h"
#include "viz/png.h"

namespace sf::apps {

FrameSink::FrameSink(const VideoOptions& options, int width, int height)
    : file_(options.frames.empty() ? options.video : options.frames), frames_per_second_(options.video_fps) {
  if (options.frames.empty())
    video_.emplace(file_, viz::VideoFormat{width, height, options.video_fps});
  else
    begin_numbered_files(file_, "", ".png");
}

void FrameSink::add(const viz::PixelImage& image) {
  if (video_)
    video_->add(image);
  else
    viz::write_png(fmt::format("{}/{:06}.png", file_, frames_), image.rgb, image.width, image.height);
  ++frames_;
}

VideoFacts FrameSink::finish() {
  if (video_) video_->finish();
  VideoFacts facts{file_, frames_, static_cast<double>(frames_) / frames_per_second_};
  std::error_code ignored;
  if (video_) facts.bytes = std::filesystem::file_size(file_, ignored);
  return facts;
}

std::string video_text(const VideoFacts& facts) {
  std::string text = fmt::format("{}, {:g} s", counted(facts.frames, "frame"), facts.seconds);
  if (facts.bytes > 0) text += fmt::format(", {:.2f} MB", 1e-6 * static_cast<double>(facts.bytes));
  return text;
}

}  // namespace sf::apps
