#include "cluster/failure.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <stdexcept>
#include <vector>

#include "base/bytes.h"
#include "base/error.h"

namespace sf::cluster {

namespace {

/// The second of three ranks; the blocks of the other ranks are fixed.
class SecondOfThree final : public Ranks {
 public:
  SecondOfThree(base::Bytes first, base::Bytes third) : first_(std::move(first)), third_(std::move(third)) {}
  unsigned rank() const override { return 1; }
  unsigned size() const override { return 3; }
  unsigned local_size() const override { return 3; }
  void begin(Block block) override { own_.assign(block.begin(), block.end()); }
  std::span<const Block> finish() override {
    blocks_ = {first_, own_, third_};
    return blocks_;
  }
  std::span<const Block> swap(std::span<const base::Bytes>) override { return {}; }
  [[noreturn]] void abort(int code) override { std::_Exit(code); }

 private:
  base::Bytes first_, own_, third_;
  std::vector<Block> blocks_;
};

base::Bytes error_of(std::uint8_t code, const char* message) {
  base::Bytes bytes;
  base::ByteWriter out(bytes);
  out.put(code);
  out.put_string(message);
  return bytes;
}

/// Returns "code: message" of the exception thrown by `agree`; empty if there is none.
std::string agreed(Ranks& ranks, const std::function<void()>& body) {
  try {
    agree(ranks, body);
  } catch (const Failure& failure) {
    return std::to_string(failure.code()) + ": " + failure.what();
  }
  return "";
}

TEST(Failure, NotThrownIfAllSucceed) {
  SecondOfThree ranks({}, {});
  EXPECT_EQ(agreed(ranks, [] {}), "");
}

TEST(Failure, ErrorOfAnotherRankIsThrown) {
  SecondOfThree ranks({}, error_of(3, "no device"));
  EXPECT_EQ(agreed(ranks, [] {}), "3: no device");
}

TEST(Failure, OwnErrorKeepsItsType) {
  SecondOfThree ranks({}, {});
  EXPECT_EQ(agreed(ranks, [] { throw base::InputError("f.world", 3, "bad"); }), "2: f.world:3: bad");
  EXPECT_EQ(agreed(ranks, [] { throw base::DeviceError("none"); }), "3: none");
  EXPECT_EQ(agreed(ranks, [] { throw std::runtime_error("other"); }), "1: other");
}

TEST(Failure, ReportsTheErrorOfTheFirstRank) {
  SecondOfThree ranks(error_of(2, "first"), error_of(2, "third"));
  EXPECT_EQ(agreed(ranks, [] { throw base::InputError("second"); }), "2: first");
}

}  // namespace

}  // namespace sf::cluster
