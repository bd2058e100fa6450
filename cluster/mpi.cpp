// The ranks of an MPI job. No other source includes MPI.

#include <mpi.h>

#include <chrono>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "cluster/ranks.h"

namespace sf::cluster {

namespace {

using Clock = std::chrono::steady_clock;

class MpiRanks final : public Ranks {
 public:
  /// @param owner true: finalizes MPI when it is destroyed; false: the program itself uses MPI and finalizes it
  explicit MpiRanks(bool owner) : owner_(owner) {
    int rank = 0, size = 1, local_size = 1;
    MPI_Comm_dup(MPI_COMM_WORLD, &all_ranks_);  // separate from messages of such a program
    MPI_Comm_rank(all_ranks_, &rank);
    MPI_Comm_size(all_ranks_, &size);
    MPI_Comm machine = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
    MPI_Comm_size(machine, &local_size);
    MPI_Comm_free(&machine);
    rank_ = static_cast<unsigned>(rank);
    size_ = static_cast<unsigned>(size);
    local_size_ = static_cast<unsigned>(local_size);
    for (auto* sizes : {&sizes_, &starts_, &sent_sizes_, &sent_starts_, &got_sizes_, &got_starts_})
      sizes->resize(size_);
    blocks_.resize(size_);
    got_blocks_.resize(size_);
  }
  ~MpiRanks() override {
    int ended = 0;
    MPI_Finalized(&ended);
    if (ended == 0 && owner_) MPI_Finalize();
  }

  unsigned rank() const override { return rank_; }
  unsigned size() const override { return size_; }
  unsigned local_size() const override { return local_size_; }

  void begin(Block block) override {
    const auto start = Clock::now();
    block_ = block;
    own_size_ = static_cast<int>(block.size());
    MPI_Iallgather(&own_size_, 1, MPI_INT, sizes_.data(), 1, MPI_INT, all_ranks_, &request_);
    ++counts_.exchanges;
    counts_.bytes += block.size();
    count(start);
  }

  std::span<const Block> finish() override {
    const auto start = Clock::now();
    MPI_Wait(&request_, MPI_STATUS_IGNORE);
    std::exclusive_scan(sizes_.begin(), sizes_.end(), starts_.begin(), 0);
    all_.resize(static_cast<std::size_t>(starts_.back()) + static_cast<std::size_t>(sizes_.back()));
    MPI_Allgatherv(block_.data(), own_size_, MPI_BYTE, all_.data(), sizes_.data(), starts_.data(), MPI_BYTE,
                   all_ranks_);
    for (unsigned r = 0; r < size_; ++r)
      blocks_[r] = Block(all_).subspan(static_cast<std::size_t>(starts_[r]), static_cast<std::size_t>(sizes_[r]));
    count(start);
    return blocks_;
  }

  std::span<const Block> swap(std::span<const base::Bytes> to) override {
    const auto start = Clock::now();
    sent_.clear();
    for (unsigned r = 0; r < size_; ++r) {
      sent_starts_[r] = static_cast<int>(sent_.size());
      sent_sizes_[r] = static_cast<int>(to[r].size());
      sent_.insert(sent_.end(), to[r].begin(), to[r].end());
    }
    MPI_Alltoall(sent_sizes_.data(), 1, MPI_INT, got_sizes_.data(), 1, MPI_INT, MPI_COMM_WORLD);
    std::exclusive_scan(got_sizes_.begin(), got_sizes_.end(), got_starts_.begin(), 0);
    got_.resize(static_cast<std::size_t>(got_starts_.back()) + static_cast<std::size_t>(got_sizes_.back()));
    MPI_Alltoallv(sent_.data(), sent_sizes_.data(), sent_starts_.data(), MPI_BYTE, got_.data(), got_sizes_.data(),
                  got_starts_.data(), MPI_BYTE, MPI_COMM_WORLD);
    for (unsigned r = 0; r < size_; ++r)
      got_blocks_[r] =
          Block(got_).subspan(static_cast<std::size_t>(got_starts_[r]), static_cast<std::size_t>(got_sizes_[r]));
    ++counts_.exchanges;
    counts_.bytes += sent_.size() - to[rank_].size();
    count(start);
    return got_blocks_;
  }

  [[noreturn]] void abort(int code) override {
    MPI_Abort(MPI_COMM_WORLD, code);
    std::_Exit(code);
  }

 private:
  void count(Clock::time_point start) { counts_.wait_s += std::chrono::duration<double>(Clock::now() - start).count(); }

  bool owner_;
  MPI_Comm all_ranks_ = MPI_COMM_NULL;
  unsigned rank_ = 0, size_ = 1, local_size_ = 1;
  Block block_;
  int own_size_ = 0;                 ///< [byte] of `block_`
  std::vector<int> sizes_, starts_;  ///< [byte] per rank
  std::vector<std::uint8_t> all_;
  std::vector<Block> blocks_;
  std::vector<int> sent_sizes_, sent_starts_, got_sizes_, got_starts_;  ///< [byte] per rank, of a swap
  std::vector<std::uint8_t> sent_, got_;
  std::vector<Block> got_blocks_;
  MPI_Request request_ = MPI_REQUEST_NULL;
};

}  // namespace

}  // namespace sf::cluster

extern "C" {
sf::cluster::Ranks* sensorfarm_mpi();

sf::cluster::Ranks* sensorfarm_mpi() {
  int ended = 0, begun = 0, level = 0;
  MPI_Finalized(&ended);
  MPI_Initialized(&begun);
  if (ended != 0) return nullptr;
  if (begun != 0) return new sf::cluster::MpiRanks(false);
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &level) != MPI_SUCCESS) return nullptr;
  return new sf::cluster::MpiRanks(true);
}
}
