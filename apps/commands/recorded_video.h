#pragma once
// `plot --video` and `view --frames`: writes a recording as a video, or its frames as PNG files.

#include "apps/commands/run_video.h"
#include "apps/options/recording_part.h"

namespace sf::apps {

/// Shows the chosen robots and time span. Scans that the recording lacks are recomputed without noise.
/// @throws Incomplete if a stop was requested; the video then ends early but is valid
void write_recorded_video(RecordingPart& part, const VideoOptions& options, const std::string& device);

}  // namespace sf::apps
