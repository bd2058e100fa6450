#pragma once
// Ranks that are threads of this process, so tests need no MPI.

#include <barrier>
#include <cstdlib>
#include <functional>
#include <thread>
#include <vector>

#include "cluster/ranks.h"

namespace sf::cluster {

class ThreadRanks {
 public:
  explicit ThreadRanks(unsigned count) : barrier_(count), blocks_(count), swapped_(count) {}

  /// Runs `body` once per rank, concurrently.
  void run(const std::function<void(Ranks&)>& body) {
    std::vector<std::jthread> threads;
    for (unsigned rank = 0; rank < blocks_.size(); ++rank)
      threads.emplace_back([&, rank] {
        One one(*this, rank);
        body(one);
      });
  }

 private:
  class One final : public Ranks {
   public:
    One(ThreadRanks& all, unsigned rank) : all_(all), rank_(rank), copies_(all.blocks_.size()), got_(copies_.size()) {}
    unsigned rank() const override { return rank_; }
    unsigned size() const override { return static_cast<unsigned>(copies_.size()); }
    unsigned local_size() const override { return size(); }
    void begin(Block block) override { block_ = block; }
    std::span<const Block> finish() override {
      all_.blocks_[rank_] = block_;
      return take([&](unsigned r) { return all_.blocks_[r]; });
    }
    std::span<const Block> swap(std::span<const base::Bytes> to) override {
      all_.swapped_[rank_] = to;
      return take([&](unsigned r) { return Block(all_.swapped_[r][rank_]); });
    }
    [[noreturn]] void abort(int code) override { std::_Exit(code); }

   private:
    std::span<const Block> take(const std::function<Block(unsigned)>& from) {
      all_.barrier_.arrive_and_wait();
      for (unsigned r = 0; r < size(); ++r) {
        const Block block = from(r);
        copies_[r].assign(block.begin(), block.end());
        got_[r] = copies_[r];
      }
      all_.barrier_.arrive_and_wait();
      return got_;
    }

    ThreadRanks& all_;
    unsigned rank_;
    Block block_;
    std::vector<base::Bytes> copies_;
    std::vector<Block> got_;
  };

  std::barrier<> barrier_;
  std::vector<Block> blocks_;
  std::vector<std::span<const base::Bytes>> swapped_;
};

}  // namespace sf::cluster
