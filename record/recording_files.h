#pragma once
// Files as recordings need them: one that grows behind a name which always holds something whole, and one to look at.

#include <cstdint>
#include <span>
#include <string>

namespace sf::record {

/// A file that takes over `path` only when told to. Bytes go to the kernel at once (no buffer of ours), so a killed
/// process loses nothing that was appended. One writer at a time: a second one on the same path is refused while the
/// first lives.
class GrowingFile {
 public:
  /// Creates the directories above `path`, and `path`.new.
  /// @throws base::InputError when that cannot be, or when another process is writing here.
  explicit GrowingFile(const std::string& path);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  /// @throws base::InputError when not everything could be written (a full disk); what was appended before stays.
  void append(std::span<const std::uint8_t> bytes);
  /// Puts the file in the place of whatever `path` was, in one step.
  void publish();
  /// Waits until the bytes are on the disk. @throws base::InputError when they cannot be.
  void sync();

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }  ///< [byte]

 private:
  void refuse_second_writer();
  [[noreturn]] void fail(const std::string& doing) const;

  std::string path_;
  std::string fresh_;  ///< the name before `publish`
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  bool published_ = false;
};

/// A whole file as read-only memory. It must not shrink meanwhile; growing does no harm.
class MappedFile {
 public:
  /// @throws base::InputError when it is not a file that can be read.
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::uint8_t> bytes() const { return bytes_; }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace sf::record
