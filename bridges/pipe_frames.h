#pragma once
// Frames between the farm and the Fast DDS process, over two pipes.

#include <unistd.h>

#include <cerrno>
#include <cstdint>

#include "base/bytes.h"

namespace sf::bridges {

enum class FrameKind : std::uint8_t {
  open,     ///< to the process, once: its settings
  ready,    ///< from the process, once: its endpoints are ready
  failed,   ///< from the process, instead of `ready`: the error
  request,  ///< from the process: a request to `service`, from `sender`
  reply,    ///< to the process: a reply of `service`, to `sender`
  log,      ///< from the process: a line
};

struct Frame {
  FrameKind kind = FrameKind::log;
  std::uint64_t service = 0, sender = 0;
  base::Bytes bytes;
};

/// Blocks.
/// @return false: the other end is closed or does not read
inline bool write_frame(int pipe, const Frame& frame) {
  base::Bytes out;
  base::ByteWriter writer(out);
  writer.put(static_cast<std::uint32_t>(frame.bytes.size()));
  writer.put(static_cast<std::uint8_t>(frame.kind));
  writer.put(frame.service);
  writer.put(frame.sender);
  writer.put_bytes(frame.bytes.data(), frame.bytes.size());
  for (std::size_t done = 0; done < out.size();) {
    const ssize_t written = ::write(pipe, out.data() + done, out.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    done += static_cast<std::size_t>(written);
  }
  return true;
}

/// Blocks.
/// @return false: the pipe ended
inline bool read_all(int pipe, std::uint8_t* out, std::size_t size) {
  while (size > 0) {
    const ssize_t count = ::read(pipe, out, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    out += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

/// Blocks.
/// @param most [byte] maximum size of a frame
/// @return false: the pipe ended, or a frame is longer
inline bool read_frame(int pipe, Frame& frame, std::uint32_t most) {
  std::uint8_t head[21];
  if (!read_all(pipe, head, sizeof head)) return false;
  base::ByteReader in(head);
  const auto size = in.get<std::uint32_t>();
  frame.kind = static_cast<FrameKind>(in.get<std::uint8_t>());
  frame.service = in.get<std::uint64_t>();
  frame.sender = in.get<std::uint64_t>();
  if (size > most) return false;
  frame.bytes.resize(size);
  return read_all(pipe, frame.bytes.data(), size);
}

}  // namespace sf::bridges
