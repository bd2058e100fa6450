#include "netio/reading_assembler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "netio/sender_bindings.h"
#include "tests/units.h"

namespace sf::netio {
namespace {

/// Readings of three parts with two numbers each: 10 * sequence + part, twice.
struct Parts {
  ReadingAssembler assembler{6};
  std::int64_t now = 0;

  PartStatus send(std::uint32_t sequence, std::uint32_t part, std::uint32_t parts = 3, std::int64_t time = 0) {
    return assembler.take({sequence, part, parts, time}, now, [&](std::span<double> values) {
      values[2 * part] = values[2 * part + 1] = 10.0 * sequence + part;
    });
  }
  std::vector<double> values() const {
    const auto whole = assembler.newest();
    return whole ? std::vector<double>(whole->values.begin(), whole->values.end()) : std::vector<double>{};
  }
};

/// Readings of one number in one part.
struct Plain {
  ReadingAssembler assembler{1};
  PartStatus send(std::uint32_t sequence, std::int64_t now = 0) {
    return assembler.take({sequence, 0, 1, now}, now, [&](std::span<double> values) { values[0] = sequence; });
  }
  double value() const { return assembler.newest() ? assembler.newest()->values[0] : NAN; }
};

TEST(ReadingAssembler, HasNoReadingInitially) {
  EXPECT_FALSE(ReadingAssembler(3).newest());
  EXPECT_EQ(ReadingAssembler(3).lost(), 0u);
}

TEST(ReadingAssembler, LastPartCompletesTheReading) {
  Parts p;
  EXPECT_EQ(p.send(4, 2), PartStatus::incomplete);  // in any order
  EXPECT_EQ(p.send(4, 0), PartStatus::incomplete);
  EXPECT_TRUE(p.values().empty());
  p.now = 9;
  EXPECT_EQ(p.send(4, 1), PartStatus::complete);
  EXPECT_EQ(p.values(), (std::vector<double>{40, 40, 41, 41, 42, 42}));
  EXPECT_EQ(p.assembler.newest()->sequence, 4u);
  EXPECT_EQ(p.assembler.newest()->arrival, 9);
  EXPECT_EQ(p.assembler.lost(), 0u);
}

TEST(ReadingAssembler, ValuesOfMissingPartsAreNotANumber) {
  ReadingAssembler assembler(3);
  assembler.take({0, 0, 1, 0}, 0, [](std::span<double> values) { values[1] = 5.0; });
  EXPECT_TRUE(std::isnan(assembler.newest()->values[0]));
  EXPECT_EQ(assembler.newest()->values[1], 5.0);
  assembler.take({1, 0, 1, 0}, 0, [](std::span<double>) {});  // memory that was used before
  EXPECT_TRUE(std::isnan(assembler.newest()->values[1]));
}

TEST(ReadingAssembler, PartsOfTwoReadingsMayInterleave) {
  Parts p;
  p.send(1, 0);
  p.send(2, 0);
  p.send(1, 1);
  p.send(2, 2);
  EXPECT_EQ(p.send(1, 2), PartStatus::complete);
  EXPECT_EQ(p.values()[0], 10.0);
  EXPECT_EQ(p.send(2, 1), PartStatus::complete);
  EXPECT_EQ(p.values()[0], 20.0);
}

TEST(ReadingAssembler, NewerCompleteReadingAbandonsOlderOnes) {
  Parts p;
  p.send(1, 0);
  for (const std::uint32_t part : {0u, 1u, 2u}) p.send(2, part);
  EXPECT_EQ(p.send(1, 1), PartStatus::late);
  EXPECT_EQ(p.send(1, 2), PartStatus::late);
  EXPECT_EQ(p.values()[0], 20.0);
}

TEST(ReadingAssembler, RepetitionsAreDuplicates) {
  Parts p;
  p.send(1, 0);
  EXPECT_EQ(p.send(1, 0), PartStatus::duplicate);  // while parts are missing
  p.send(1, 1);
  p.send(1, 2);
  EXPECT_EQ(p.send(1, 2), PartStatus::duplicate);  // after it is complete
}

TEST(ReadingAssembler, LimitsReadingsInProgress) {
  Parts p;
  for (std::uint32_t sequence = 0; sequence <= ReadingAssembler::kMaxPartial; ++sequence) p.send(sequence, 0);
  EXPECT_EQ(p.send(0, 1), PartStatus::late);  // abandoned for the newest reading
  p.send(1, 1);
  EXPECT_EQ(p.send(1, 2), PartStatus::complete);  // the oldest in progress
}

TEST(ReadingAssembler, DropsPartsThatContradictTheirReading) {
  Parts p;
  p.send(1, 0);
  EXPECT_EQ(p.send(1, 1, 2), PartStatus::late);     // different number of parts
  EXPECT_EQ(p.send(1, 1, 3, 7), PartStatus::late);  // different time of measurement
  EXPECT_EQ(p.send(1, 1, 3, 0), PartStatus::incomplete);
}

TEST(ReadingAssembler, NeverReturnsToAnOlderReading) {
  Plain p;
  EXPECT_EQ(p.send(5), PartStatus::complete);
  EXPECT_EQ(p.send(4), PartStatus::late);
  EXPECT_EQ(p.value(), 5.0);
  EXPECT_EQ(p.send(9), PartStatus::complete);
  EXPECT_EQ(p.assembler.lost(), 3u);  // 6, 7, 8; losses before the first reading do not count
}

TEST(ReadingAssembler, SequencesWrap) {
  Plain p;
  EXPECT_EQ(p.send(0xFFFFFFFEu), PartStatus::complete);
  EXPECT_EQ(p.send(1), PartStatus::complete);
  EXPECT_EQ(p.send(0xFFFFFFFFu), PartStatus::late);  // arrives late
  EXPECT_EQ(p.assembler.lost(), 1u);                 // 0
}

TEST(ReadingAssembler, RestartedSenderIsAcceptedAfterTwoSeconds) {
  Plain p;
  p.send(5000, 0);
  EXPECT_EQ(p.send(0, 2 * kSecond - 1), PartStatus::late);
  EXPECT_EQ(p.assembler.restarts(), 0u);
  EXPECT_EQ(p.send(1, 2 * kSecond), PartStatus::complete);
  EXPECT_EQ(p.value(), 1.0);
  EXPECT_EQ(p.assembler.restarts(), 1u);
  EXPECT_EQ(p.send(2, 2 * kSecond + 1), PartStatus::complete);
}

TEST(ReadingAssembler, NewerReadingsAfterSilenceAreNotARestart) {
  Plain p;
  p.send(5, 0);
  EXPECT_EQ(p.send(7, 10 * kSecond), PartStatus::complete);
  EXPECT_EQ(p.assembler.restarts(), 0u);
  EXPECT_EQ(p.assembler.lost(), 1u);
}

/// A forged datagram must not make later ones late.
TEST(ReadingAssembler, DropsJumps) {
  Plain p;
  std::uint64_t whole = 0;
  for (std::uint32_t i = 0; i < 72; ++i) {
    whole += p.send(1000 + i, i * kTick) == PartStatus::complete;
    EXPECT_EQ(p.send(100'000 + i, i * kTick + 1), PartStatus::jump);
    EXPECT_EQ(p.send(0x80000000u, i * kTick + 2), PartStatus::jump);
  }
  EXPECT_EQ(whole, 72u);
  EXPECT_EQ(p.assembler.lost(), 0u);
}

TEST(ReadingAssembler, JumpLimitsAreInclusive) {
  const auto after = [](std::uint32_t ahead, std::int64_t time, std::int64_t now) {
    ReadingAssembler assembler(1);
    assembler.take({5, 0, 1, kSecond}, 0, [](std::span<double>) {});
    return assembler.take({5 + ahead, 0, 1, kSecond + time}, now, [](std::span<double>) {});
  };
  EXPECT_EQ(after(ReadingAssembler::kMaxDropout, 0, 0), PartStatus::complete);
  EXPECT_EQ(after(ReadingAssembler::kMaxDropout + 1, 0, 0), PartStatus::jump);
  EXPECT_EQ(after(1, ReadingAssembler::kMaxTimeJump, 0), PartStatus::complete);
  EXPECT_EQ(after(1, ReadingAssembler::kMaxTimeJump + 1, 0), PartStatus::jump);
  EXPECT_EQ(after(1, ReadingAssembler::kMaxTimeJump + 1, 1), PartStatus::complete);  // it arrived later by the same
                                                                                     // time
  EXPECT_EQ(after(1, -1, 0), PartStatus::jump);                                      // newer, but measured earlier
  EXPECT_EQ(after(ReadingAssembler::kMaxDropout + 1, 0, 2 * kSecond - 1), PartStatus::jump);
  EXPECT_EQ(after(ReadingAssembler::kMaxDropout + 1, 0, 2 * kSecond),
            PartStatus::complete);  // after silence any part is accepted
}

TEST(ReadingAssembler, AcceptsAnotherSenderAfterRestart) {
  Plain p;
  p.send(5000, 0);
  p.assembler.restart();
  EXPECT_FALSE(p.assembler.newest());
  EXPECT_EQ(p.send(0, 1), PartStatus::complete);
  EXPECT_EQ(p.assembler.restarts(), 1u);
}

// For any order, repetition and loss, the newest reading is complete, correct, and never older than before.
TEST(ReadingAssembler, HandlesAnyArrivalOrder) {
  std::mt19937 random(7);  // NOLINT: the same every time
  std::uint64_t whole = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pieces;
    const std::uint32_t first = 0xFFFFFFF0u;  // across the wrap-around
    for (std::uint32_t k = 0; k < 40; ++k)
      for (std::uint32_t part = 0; part < 3; ++part)
        for (std::uint32_t copies = random() % 4; copies > 0; --copies) pieces.emplace_back(first + k, part);
    for (std::size_t i = 0; i + 1 < pieces.size(); ++i)
      std::swap(pieces[i], pieces[i + random() % std::min<std::size_t>(12, pieces.size() - i)]);

    Parts p;
    std::map<std::uint32_t, std::set<std::uint32_t>> arrived;
    std::optional<std::uint32_t> newest;
    for (const auto& [sequence, part] : pieces) {
      arrived[sequence].insert(part);
      if (p.send(sequence, part) == PartStatus::complete) {
        ++whole;
        ASSERT_TRUE(!newest || newer(sequence, *newest));
        ASSERT_EQ(arrived[sequence].size(), 3u) << "complete before its parts arrived";
        newest = sequence;
      }
      if (!newest) continue;
      ASSERT_EQ(p.assembler.newest()->sequence, *newest);
      for (std::uint32_t i = 0; i < 6; ++i) ASSERT_EQ(p.values()[i], 10.0 * *newest + i / 2);
    }
  }
  EXPECT_GT(whole, 1000u);
}

}  // namespace
}  // namespace sf::netio
