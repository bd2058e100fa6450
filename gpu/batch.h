#pragma once
// One submit and one wait per tick: copies up, kernels, copies down.

#include <cstddef>
#include <memory>

#include "gpu/buffer.h"
#include "gpu/device.h"
#include "gpu/kernel.h"

namespace sf::gpu {

/// Kernels are recorded once, copies are named each tick (and cost nothing where memory is unified).
class Batch {
 public:
  explicit Batch(Device& device);
  ~Batch();
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;

  /// Starts a new recording: to be called again only when kernels or tables were replaced.
  void begin();
  /// Runs `kernel` with the group counts (x, y, z as u32) found in `counts` at `offset` [bytes] when the batch runs.
  void dispatch(const Kernel& kernel, const Buffer& counts, std::size_t offset);
  /// What is dispatched from here on sees what the dispatches before wrote.
  void barrier();
  void end();

  /// This tick's bytes to copy, from the host view up or from the device down.
  void upload(const Buffer& table, std::size_t offset, std::size_t size);
  void download(const Buffer& table, std::size_t offset, std::size_t size);

  /// Submits all of it once and waits.
  void run();

  struct Vk;

 private:
  std::unique_ptr<Vk> vk_;
};

}  // namespace sf::gpu
