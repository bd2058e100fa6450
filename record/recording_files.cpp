#include "record/recording_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "base/error.h"

namespace sf::record {

namespace {

bool same_file(const struct stat& a, const struct stat& b) { return a.st_dev == b.st_dev && a.st_ino == b.st_ino; }

/// Returns whether a living process holds the lock of `path`. A link does not count as a recording.
bool is_being_written(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
  if (descriptor < 0) return false;
  const bool held = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return held;
}

}  // namespace

GrowingFile::GrowingFile(const std::string& path) : path_(path) {
  std::error_code error;
  // A plug-in may change the working directory before `publish`.
  whole_ = std::filesystem::absolute(path, error).string();
  fresh_ = whole_ + ".new";
  const auto directory = std::filesystem::path(path).parent_path();
  if (!directory.empty()) std::filesystem::create_directories(directory, error);
  if (error)
    throw base::InputError(
        directory.string(), 0,
        "cannot be created as a directory: " + error.message() + "; choose one in a directory that you can write to");

  create();
  try {
    refuse_second_writer();
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

/// Never opens an existing file or the target of a link of that name. Removes the file of a run that has ended.
void GrowingFile::create() {
  constexpr int kFlags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
  descriptor_ = ::open(fresh_.c_str(), kFlags, 0666);
  if (descriptor_ < 0 && errno == EEXIST) {
    if (is_being_written(fresh_)) refuse();
    if (::unlink(fresh_.c_str()) != 0 && errno != ENOENT) fail("be written");
    descriptor_ = ::open(fresh_.c_str(), kFlags, 0666);
    if (descriptor_ < 0 && errno == EEXIST) refuse();
  }
  if (descriptor_ < 0) fail("be written");
}

void GrowingFile::refuse_second_writer() {
  struct stat mine = {};
  struct stat named = {};
  // File systems without locks do not refuse a second writer.
  const bool held = ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  // Between creating and locking, another writer may have mistaken the file for that of an ended run.
  const bool still_named =
      !held && ::fstat(descriptor_, &mine) == 0 && ::lstat(fresh_.c_str(), &named) == 0 && same_file(mine, named);
  if (still_named && !is_being_written(whole_)) return;
  if (still_named) ::unlink(fresh_.c_str());
  refuse();
}

void GrowingFile::refuse() const {
  throw base::InputError(path_, 0,
                         "another run is being recorded here: wait until it ends, or choose another directory");
}

GrowingFile::~GrowingFile() {
  ::close(descriptor_);
  if (!published_) ::unlink(fresh_.c_str());
}

void GrowingFile::append(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("take more than " + std::to_string(size_) + " bytes");
    size_ += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void GrowingFile::publish() {
  if (std::rename(fresh_.c_str(), whole_.c_str()) != 0) fail("be replaced");
  published_ = true;
}

void GrowingFile::sync() {
  if (::fsync(descriptor_) != 0) fail("be kept on the disk");
}

void GrowingFile::fail(const std::string& doing) const {
  throw base::InputError(path_, 0, "cannot " + doing + ": " + std::strerror(errno));
}

MappedFile::MappedFile(const std::string& path) {
  struct stat status = {};
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) throw base::InputError(path, 0, std::string("cannot be read: ") + std::strerror(errno));
  const bool regular = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  const auto size = static_cast<std::size_t>(status.st_size);
  void* const at = regular && size > 0 ? ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0) : nullptr;
  ::close(descriptor);
  if (!regular) throw base::InputError(path, 0, "is not a file");
  if (at == MAP_FAILED) throw base::InputError(path, 0, std::string("cannot be read: ") + std::strerror(errno));
  if (at != nullptr) bytes_ = {static_cast<const std::uint8_t*>(at), size};
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) ::munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
}

}  // namespace sf::record
