// The video plug-in, the only source that includes FFmpeg: VP9 (libvpx) in WebM.

#include "viz/video_backend.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <memory>

namespace sf::viz {
namespace {

constexpr int kSecondsPerKeyFrame = 4;  // players seek from one key frame to the next

std::string reason(int error) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  return av_make_error_string(text, sizeof text, error);
}

struct FreeCodec {
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
};
struct FreeFrame {
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
struct FreePacket {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
struct FreeScaler {
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};
struct FreeFile {
  void operator()(AVFormatContext* file) const {
    avio_closep(&file->pb);
    avformat_free_context(file);
  }
};

struct Video {
  std::unique_ptr<AVFormatContext, FreeFile> file;
  std::unique_ptr<AVCodecContext, FreeCodec> codec;
  std::unique_ptr<AVFrame, FreeFrame> frame;
  std::unique_ptr<AVPacket, FreePacket> packet;
  std::unique_ptr<SwsContext, FreeScaler> scaler;
  AVStream* stream = nullptr;  ///< owned by `file`
  std::int64_t frames = 0;
};

/// Uses one thread and writes no date or version into the file, so that equal frames give equal bytes.
void choose_settings(AVCodecContext& codec, const VideoFormat& format) {
  codec.width = format.width;
  codec.height = format.height;
  codec.pix_fmt = AV_PIX_FMT_YUV420P;
  codec.color_range = AVCOL_RANGE_MPEG;
  codec.colorspace = AVCOL_SPC_BT709;
  codec.color_primaries = AVCOL_PRI_BT709;
  codec.color_trc = AVCOL_TRC_BT709;
  codec.time_base = {1, format.frames_per_second};
  codec.framerate = {format.frames_per_second, 1};
  codec.gop_size = kSecondsPerKeyFrame * format.frames_per_second;
  codec.thread_count = 1;
  codec.flags |= AV_CODEC_FLAG_BITEXACT;
  codec.bit_rate = 0;  // constant quality
  av_opt_set(codec.priv_data, "crf", "24", 0);
  av_opt_set(codec.priv_data, "deadline", "realtime", 0);
  av_opt_set(codec.priv_data, "cpu-used", "7", 0);
  av_opt_set(codec.priv_data, "row-mt", "0", 0);
  av_opt_set(codec.priv_data, "lag-in-frames", "0", 0);
}

bool begin(Video& video, const char* path, const VideoFormat& format, std::string& why) {
  const AVCodec* const encoder = avcodec_find_encoder_by_name("libvpx-vp9");
  if (encoder == nullptr) {
    why = "this FFmpeg has no VP9 encoder (libvpx-vp9)";
    return false;
  }
  const auto failed = [&](int code) {
    if (code < 0) why = reason(code);
    return code < 0;
  };
  AVFormatContext* file = nullptr;
  const std::string url = "file:" + std::string(path);  // prevents other protocols, whatever the file name
  if (failed(avformat_alloc_output_context2(&file, nullptr, "webm", url.c_str()))) return false;
  video.file.reset(file);
  file->flags |= AVFMT_FLAG_BITEXACT;
  video.codec.reset(avcodec_alloc_context3(encoder));
  video.frame.reset(av_frame_alloc());
  video.packet.reset(av_packet_alloc());
  video.stream = avformat_new_stream(file, nullptr);
  video.scaler.reset(sws_getContext(format.width, format.height, AV_PIX_FMT_RGB24, format.width, format.height,
                                    AV_PIX_FMT_YUV420P, SWS_BILINEAR | SWS_ACCURATE_RND | SWS_BITEXACT, nullptr,
                                    nullptr, nullptr));
  if (!video.codec || !video.frame || !video.packet || video.stream == nullptr || !video.scaler) {
    why = "not enough memory";
    return false;
  }
  const int* const bt709 = sws_getCoefficients(SWS_CS_ITU709);
  sws_setColorspaceDetails(video.scaler.get(), bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16);
  choose_settings(*video.codec, format);
  if (failed(avcodec_open2(video.codec.get(), encoder, nullptr))) return false;
  video.stream->time_base = video.codec->time_base;
  video.stream->avg_frame_rate = video.codec->framerate;
  if (failed(avcodec_parameters_from_context(video.stream->codecpar, video.codec.get()))) return false;
  AVFrame& frame = *video.frame;
  frame.format = video.codec->pix_fmt;
  frame.width = format.width;
  frame.height = format.height;
  if (failed(av_frame_get_buffer(&frame, 0))) return false;
  return !failed(avio_open(&file->pb, url.c_str(), AVIO_FLAG_WRITE)) && !failed(avformat_write_header(file, nullptr));
}

/// Passes a frame to the encoder, or null at the end, and writes the finished packets. @return error code
int encode(Video& video, const AVFrame* frame) {
  int code = avcodec_send_frame(video.codec.get(), frame);
  while (code >= 0) {
    code = avcodec_receive_packet(video.codec.get(), video.packet.get());
    if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return 0;
    if (code < 0) return code;
    video.packet->duration = 1;
    av_packet_rescale_ts(video.packet.get(), video.codec->time_base, video.stream->time_base);
    video.packet->stream_index = video.stream->index;
    code = av_interleaved_write_frame(video.file.get(), video.packet.get());
    if (code >= 0 && video.file->pb->error < 0) code = video.file->pb->error;
  }
  return code;
}

void* open(const char* file, const VideoFormat& format, std::string& why) {
  av_log_set_level(AV_LOG_QUIET);
  auto video = std::make_unique<Video>();
  return begin(*video, file, format, why) ? video.release() : nullptr;
}

bool add(void* of, const std::uint8_t* rgb, std::string& why) {
  Video& video = *static_cast<Video*>(of);
  AVFrame& frame = *video.frame;
  int code = av_frame_make_writable(&frame);
  if (code >= 0) {
    const int stride = 3 * frame.width;
    sws_scale(video.scaler.get(), &rgb, &stride, 0, frame.height, frame.data, frame.linesize);
    frame.pts = video.frames++;
    code = encode(video, &frame);
  }
  if (code < 0) why = reason(code);
  return code >= 0;
}

bool close(void* of, std::string& why) {
  const std::unique_ptr<Video> video(static_cast<Video*>(of));
  int code = encode(*video, nullptr);
  if (const int trailer = av_write_trailer(video->file.get()); code >= 0) code = trailer;
  avio_flush(video->file->pb);
  if (code >= 0) code = video->file->pb->error;
  if (const int closed = avio_closep(&video->file->pb); code >= 0) code = closed;
  if (code < 0) why = reason(code);
  return code >= 0;
}

}  // namespace
}  // namespace sf::viz

extern "C" {
extern const sf::viz::VideoBackend sensorfarm_ffmpeg;
const sf::viz::VideoBackend sensorfarm_ffmpeg{sf::viz::open, sf::viz::add, sf::viz::close};
}
