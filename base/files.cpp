#include "base/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace sf::base {

namespace {

struct Descriptor {
  int number = -1;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

[[noreturn]] void fail_to_read(const std::string& file) {
  throw InputError(file, 0, fmt::format("cannot be read: {}", std::strerror(errno)));
}

[[noreturn]] void refuse_size(const std::string& file, std::size_t most) {
  throw InputError(file, 0, fmt::format("larger than {} MiB, the limit for such files", most >> 20));
}

}  // namespace

std::string read_bytes(const std::string& file, std::size_t most) {
  // O_NONBLOCK: opening a pipe without a writer would block.
  const Descriptor in{::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (in.number < 0 && (errno == ENOENT || errno == ENOTDIR))
    throw InputError(file, 0, "no such file; give the path of an existing file");
  if (in.number < 0) fail_to_read(file);
  struct stat status = {};
  if (::fstat(in.number, &status) != 0) fail_to_read(file);
  if (!S_ISREG(status.st_mode))
    throw InputError(file, 0, "not a file but a folder, a device or a pipe; give the path of an existing file");
  const auto promised = static_cast<std::size_t>(status.st_size);
  if (promised > most) refuse_size(file, most);

  std::string bytes(promised + 1, '\0');
  std::size_t have = 0;
  for (;;) {
    const ssize_t got = ::read(in.number, bytes.data() + have, bytes.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_to_read(file);
    if (got == 0) break;
    have += static_cast<std::size_t>(got);
    if (have > most) refuse_size(file, most);
    if (have == bytes.size()) bytes.resize(std::min(2 * have, most + 1));  // the file grew meanwhile
  }
  bytes.resize(have);
  if (bytes.empty()) throw InputError(file, 0, "is empty; was it saved, or copied whole?");
  return bytes;
}

std::string read_text(const std::string& file, std::size_t most) {
  std::string text = read_bytes(file, most);
  if (text.find_first_not_of(" \t\r\n\v\f") == std::string::npos)
    throw InputError(file, 0, "holds nothing but blanks; was it saved, or copied whole?");
  return text;
}

}  // namespace sf::base
