#pragma once
// Files for recordings: one for writing, which appears under its name only when it is usable, and one for reading.

#include <atomic>
#include <cstdint>
#include <span>
#include <string>

namespace sf::record {

/// A file that replaces `path` only in `publish`. Bytes are passed to the kernel without a buffer, so a killed process
/// loses no appended bytes. Allows one writer at a time: a second writer of the same path is refused while the first
/// exists.
class GrowingFile {
 public:
  /// Creates the directories above `path`, and `path`.new.
  /// @throws base::InputError if that fails, or if another process writes this recording
  explicit GrowingFile(const std::string& path);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  /// @throws base::InputError if not all bytes could be written (a full disk); earlier bytes remain
  void append(std::span<const std::uint8_t> bytes);
  /// Replaces `path` with this file, in one step.
  void publish();
  /// Waits until the bytes are on the disk. @throws base::InputError if that fails
  void sync();

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }  ///< [byte]; callable from any thread

 private:
  void create();
  void refuse_second_writer();
  [[noreturn]] void refuse() const;
  [[noreturn]] void fail(const std::string& doing) const;

  std::string path_;   ///< as given, for messages
  std::string whole_;  ///< absolute path
  std::string fresh_;  ///< absolute path before `publish`
  int descriptor_ = -1;
  std::atomic<std::uint64_t> size_ = 0;
  bool published_ = false;
};

/// A whole file as read-only memory. It must not shrink while it is mapped; it may grow.
class MappedFile {
 public:
  /// @throws base::InputError if it is not a readable file
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::uint8_t> bytes() const { return bytes_; }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace sf::record
