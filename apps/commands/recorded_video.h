#pragma once
// `plot --video` and `view --frames`: a recording as a video, or as PNG files of its frames.

#include "apps/commands/run_video.h"
#include "apps/options/recording_part.h"

namespace sf::apps {

/// Shows the chosen robots and time. Scans that the recording lacks are computed again, without noise.
/// @throws Incomplete when a stop was requested: the video is whole as far as it goes
void write_recorded_video(RecordingPart& part, const VideoOptions& options, const std::string& device);

}  // namespace sf::apps
