#pragma once
// `plot --video --video-camera` and `view --frames --video-camera`: the recorded images of a camera.

#include "apps/commands/frame_sink.h"
#include "apps/options/recording_part.h"

namespace sf::apps {

/// Writes the camera's colours, of a camera without colours its depths in grey, in the size of its images. Frame k at F
/// frames per second shows the newest image at k / F times the speed after the first one.
/// @throws base::InputError for unknown cameras, recordings without their images, and as FrameSink
/// @throws Incomplete if a stop was requested; the video then ends early but is valid
void write_camera_video(const RecordingPart& part, const VideoOptions& options);

}  // namespace sf::apps
