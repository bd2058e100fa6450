#pragma once
// One submission per tick: uploads, kernels, downloads. The host may work between `submit` and `wait`.

#include <cstddef>
#include <memory>

#include "gpu/buffer.h"
#include "gpu/device.h"
#include "gpu/kernel.h"

namespace sf::gpu {

/// Kernels are recorded once, copies are named each tick (and cost nothing on unified devices). On the host, a batch is
/// empty. Not thread-safe.
class Batch {
 public:
  explicit Batch(Device& device);
  ~Batch();
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;

  /// Starts a new recording: before the first `submit`, and when kernels or tables were replaced; not between `submit`
  /// and `wait`. What is recorded must live until the next `begin`.
  void begin();
  /// Runs `kernel` with the group counts (x, y, z as u32) that `counts` holds at `offset` [bytes] at the time of `run`.
  void dispatch(const Kernel& kernel, const Buffer& counts, std::size_t offset);
  /// Makes the results of earlier dispatches visible to later ones, to their group counts as well.
  void barrier();
  void end();

  /// Copies [offset, offset + size) [bytes] of `table` at the next `run`: from the host view to the device, or back.
  void upload(const Buffer& table, std::size_t offset, std::size_t size);
  void download(const Buffer& table, std::size_t offset, std::size_t size);

  /// Submits the recorded kernels, and the copies named since the last time. The host must not touch their tables until
  /// `wait` returns.
  void submit();
  /// Waits for the end of the submission; returns at once without one.
  void wait();
  void run() { submit(), wait(); }

  struct Vk;

 private:
  std::unique_ptr<Vk> vk_;
};

}  // namespace sf::gpu
