#include "base/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "base/error.h"

namespace sf::base {

namespace {

struct Descriptor {
  int number = -1;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

constexpr std::size_t kMaxLine = 16u << 20;
constexpr std::size_t kBlock = 1u << 20;

[[noreturn]] void fail_to_read(const std::string& file) {
  throw InputError(file, 0, fmt::format("cannot be read: {}", std::strerror(errno)));
}

[[noreturn]] void refuse_size(const std::string& file, std::size_t most) {
  throw InputError(file, 0, fmt::format("larger than {} MiB, the limit for such files", most >> 20));
}

/// Opens a regular file and sets `size` [bytes].
int open_regular(const std::string& file, std::size_t& size) {
  // O_NONBLOCK: opening a pipe without a writer would block.
  Descriptor in{::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (in.number < 0 && (errno == ENOENT || errno == ENOTDIR))
    throw InputError(file, 0, "no such file; give the path of an existing file");
  if (in.number < 0) fail_to_read(file);
  struct stat status = {};
  if (::fstat(in.number, &status) != 0) fail_to_read(file);
  if (!S_ISREG(status.st_mode))
    throw InputError(file, 0, "a folder, a device or a pipe, not a file; give the path of an existing file");
  size = static_cast<std::size_t>(status.st_size);
  return std::exchange(in.number, -1);
}

/// Reads at most `most` bytes; returns 0 at the end of the file.
std::size_t read_some(const std::string& file, int descriptor, char* out, std::size_t most) {
  for (;;) {
    const ssize_t got = ::read(descriptor, out, most);
    if (got >= 0) return static_cast<std::size_t>(got);
    if (errno != EINTR) fail_to_read(file);
  }
}

}  // namespace

std::string ending_of(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

std::string read_bytes(const std::string& file, std::size_t most) {
  std::size_t promised = 0;
  const Descriptor in{open_regular(file, promised)};
  if (promised > most) refuse_size(file, most);

  std::string bytes(promised + 1, '\0');
  std::size_t have = 0;
  for (;;) {
    const std::size_t got = read_some(file, in.number, bytes.data() + have, bytes.size() - have);
    if (got == 0) break;
    have += got;
    if (have > most) refuse_size(file, most);
    if (have == bytes.size()) bytes.resize(std::min(2 * have, most + 1));  // the file grew after its size was read
  }
  bytes.resize(have);
  if (bytes.empty()) throw InputError(file, 0, "is empty; was it saved or copied completely?");
  return bytes;
}

std::string read_text(const std::string& file, std::size_t most) {
  std::string text = read_bytes(file, most);
  if (text.find_first_not_of(" \t\r\n\v\f") == std::string::npos)
    throw InputError(file, 0, "contains only whitespace; was it saved or copied completely?");
  return text;
}

LineFile::LineFile(const std::string& file) : file_(file) {
  std::size_t size = 0;
  descriptor_ = open_regular(file, size);
}

LineFile::~LineFile() { ::close(descriptor_); }

/// Keeps the current line in the buffer.
bool LineFile::refill() {
  buffer_.erase(0, begin_);
  end_ -= begin_;
  first_end_ -= begin_;
  begin_ = 0;
  const std::size_t have = buffer_.size();
  buffer_.resize(have + kBlock);
  const std::size_t got = read_some(file_, descriptor_, buffer_.data() + have, kBlock);
  buffer_.resize(have + got);
  return got > 0;
}

/// Returns the first line end at or after `from`, relative to `begin_`, or the end of the file if there is none.
std::size_t LineFile::find_end(std::size_t from) {
  for (;;) {
    const std::size_t end = buffer_.find('\n', begin_ + from);
    if (end != std::string::npos) return end - begin_;
    from = buffer_.size() - begin_;
    if (from > kMaxLine || !refill()) return from;
  }
}

std::string_view LineFile::line_to(std::size_t end) const {
  std::string_view line = std::string_view(buffer_).substr(begin_, end - begin_);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

bool LineFile::next(std::string_view& line) {
  begin_ = std::min(end_ + 1, buffer_.size());
  end_ = first_end_ = begin_;
  number_ = last_number() + 1;
  appended_ = 0;
  const std::size_t length = find_end(0);
  if (length > kMaxLine)
    throw InputError(file_, number_, fmt::format("a line of more than {} MiB, the limit", kMaxLine >> 20));
  end_ = first_end_ = begin_ + length;
  if (begin_ == buffer_.size()) return false;
  line = line_to(end_);
  return true;
}

bool LineFile::extend(std::string_view& line) {
  bool more = end_ + 1 < buffer_.size() || refill();
  const std::size_t length = more ? find_end(end_ + 1 - begin_) : 0;
  more = more && length <= kMaxLine;
  if (more) {
    end_ = begin_ + length;
    ++appended_;
  }
  line = line_to(end_);  // the buffer may have moved
  return more;
}

void LineFile::shrink(std::string_view& line) {
  end_ = first_end_;
  appended_ = 0;
  line = line_to(end_);
}

}  // namespace sf::base
