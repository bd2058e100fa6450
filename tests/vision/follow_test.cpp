// Following of tags from camera to camera.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "tests/refusal.h"
#include "vision/positioning.h"
#include "vision/rendering/renderer.h"
#include "vision/tag_family.h"
#include "vision/testbed_patches.h"

namespace sf::vision {

namespace {

/// `count` cameras in a row, 1.3 m apart: each sees 1.6 m x 1.2 m of the tags' plane.
std::string row_of_cameras(int count, const std::string& head = "dictionary = \"aruco_4x4_50\"\n") {
  std::string text = head + "tag_side = 0.15\ntag_height = 0.2\n";
  for (int i = 0; i < count; ++i)
    text += fmt::format(
        "[[camera]]\nname = \"c{}\"\nsize = [320, 240]\nfocal = [400, 400]\nposition = [{}, 0, 2.2]\n"
        "distortion = [-0.1, 0.02, 0, 0, 0]\nexposure = 0.004\nreadout = 0.01\n",
        i, 1.3 * i);
  return text;
}

/// Renders the images of tags that move straight.
class FollowStage {
 public:
  FollowStage(const Testbed& testbed, std::vector<TrueTag> tags) : testbed_(testbed), tags_(std::move(tags)) {
    for (const TestbedCamera& each : testbed.cameras) renderers_.emplace_back(each.camera, Imaging{}, 1);
    for (const TrueTag& tag : tags_) patterns_.push_back(family_pattern(testbed.dictionary, tag.id));
    frames_.resize(renderers_.size());
  }
  /// @param covered from above, so that no tag is seen
  std::span<const Frame> images(double time, bool covered = false) {
    Scene scene;
    for (std::size_t i = 0; i < tags_.size(); ++i)
      add_tag(scene, tags_[i], 0.0, testbed_.mount(tags_[i].id).side, patterns_[i]);
    Patch cover;
    cover.X_WP.z = 1.0;
    cover.size = {100.0, 100.0};
    if (covered) scene.patches.push_back(cover);
    for (std::size_t i = 0; i < renderers_.size(); ++i) {
      renderers_[i].render(scene, time, count_, frames_[i].image);
      frames_[i].time = time;
    }
    ++count_;
    return frames_;
  }

 private:
  const Testbed& testbed_;
  std::vector<TrueTag> tags_;
  std::vector<TagPattern> patterns_;
  std::vector<Renderer> renderers_;
  std::vector<Frame> frames_;
  std::uint32_t count_ = 0;
};

bool has_same_bits(const TagFit& a, const TagFit& b) {
  const auto numbers = [](const TagFit& f) {
    return std::array{f.X_WT.x, f.X_WT.y,       f.X_WT.z, f.X_WT.yaw, f.side,       f.residual,
                      f.pixel,  f.height_sigma, f.row,    f.roll,     f.tilt_sigma, f.pitch};
  };
  const auto x = numbers(a), y = numbers(b);
  return std::memcmp(x.data(), y.data(), sizeof(x)) == 0 && a.points == b.points;
}

bool has_same_bits(const TrackedTag& a, const TrackedTag& b) {
  return a.time == b.time && a.X_WT.x == b.X_WT.x && a.X_WT.y == b.X_WT.y && a.X_WT.z == b.X_WT.z &&
         a.X_WT.yaw == b.X_WT.yaw && a.velocity == b.velocity && a.turn == b.turn && a.cameras == b.cameras;
}

std::string follow_error(const std::string& follow) {
  return refusal_of([&] { parse_testbed("t.toml", row_of_cameras(1) + "[follow]\n" + follow); });
}

/// A follower that receives sightings without images.
class FollowWatch {
 public:
  explicit FollowWatch(const std::string& follow, int cameras = 2)
      : testbed(parse_testbed("t.toml", row_of_cameras(cameras) + "[follow]\n" + follow)), follower(testbed) {}

  /// @param at x of tag `id`, seen by camera `camera` if its search includes it
  void step(std::uint32_t id, double x, std::size_t camera, bool visible = true) {
    follower.begin(time);
    const std::vector<double> times(testbed.cameras.size(), time);
    follower.plan(times, tracker, searches);
    std::vector<std::vector<Sighting>> sightings(testbed.cameras.size());
    if (visible && searches[camera].is_needed() && follower.wanted().count(id) > 0) {
      Sighting sighting{id, time, {}};
      sighting.fit.X_WT = {x, 0.0, 0.2, 0.0};
      sighting.fit.pixel = 0.005;
      sightings[camera] = {sighting};
    }
    for (std::size_t i = 0; i < absent.size(); ++i)
      if (absent[i] != 0) searches[i] = {};
    tracker.update(sightings[camera], tracked);
    follower.observe(time, searches, absent, sightings, tracker, tracked);
    time += 0.1;
  }
  int needed() const {
    int count = 0;
    for (const Search& search : searches) count += search.is_needed() ? 1 : 0;
    return count;
  }

  Testbed testbed;
  std::vector<std::uint8_t> absent = std::vector<std::uint8_t>(testbed.cameras.size());
  Tracker tracker;
  Follower follower;
  std::vector<Search> searches;
  std::vector<TrackedTag> tracked;
  double time = 0.0;
};

}  // namespace

TEST(Follow, ReadsItsSection) {
  const Testbed testbed = parse_testbed("t.toml", row_of_cameras(1) +
                                                      "[follow]\ntags = [9, 7]\nmargin = 0.1\nspeed = 2\nsearch = 3\n"
                                                      "start = \"tag 3 enters [-1, 0.5 2 1.5]\"\nstop = \"at 5 s\"\n");
  ASSERT_TRUE(testbed.follow);
  const FollowSettings& follow = *testbed.follow;
  EXPECT_EQ(follow.tags, (std::set<std::uint32_t>{7, 9}));
  EXPECT_EQ(follow.margin, 0.1);
  EXPECT_EQ(follow.speed, 2.0);
  EXPECT_EQ(follow.search, 3.0);
  EXPECT_EQ(follow.start.kind, FollowEvent::Kind::enters);
  EXPECT_EQ(follow.start.tag, 3u);
  EXPECT_EQ(follow.start.low, glm::dvec2(-1.0, 0.5));
  EXPECT_EQ(follow.start.high, glm::dvec2(1.0, 2.0));
  EXPECT_EQ(follow.stop.kind, FollowEvent::Kind::time);
  EXPECT_EQ(follow.stop.time, 5.0);
  EXPECT_FALSE(parse_testbed("t.toml", row_of_cameras(1)).follow);
}

TEST(Follow, RefusesWrongValues) {
  expect_in("unknown key 'tag'; did you mean 'tags'", follow_error("tag = [7]"));
  expect_in("expects a list of 1 to 256 ids", follow_error("tags = []"));
  expect_in("expects a list of 1 to 256 ids", follow_error("tags = 7"));
  expect_in("whole numbers from 0 to 65535", follow_error("tags = [1.5]"));
  expect_in("65535", follow_error("tags = [65536]"));
  expect_in("'margin'", follow_error("margin = -1"));
  expect_in("'speed'", follow_error("speed = 6"));
  expect_in("'search'", follow_error("search = 0"));
  for (const char* event :
       {"now", "at 5", "at -1 s", "at nan s", "at 5 s later", "tag 3 enters", "tag 3 enters [0 0 0 1]",
        "tag 3 enters [0 0 1 -1]", "tag 3 enters [0 0 1 1", "tag 3 enters [0 0 1 1] soon", "tag 3 enters [0 0 nan 1]",
        "tag -3 leaves [0 0 1 1]", "tag 70000 leaves [0 0 1 1]", "tag 3 likes [0 0 1 1]", "tag enters [0 0 1 1]"})
    expect_in("expected \"tag 3 enters [x y width height]\"", follow_error(fmt::format("start = \"{}\"", event)));
  expect_in("'stop' is not later than 'start'", follow_error("start = \"at 5 s\"\nstop = \"at 5 s\""));
  const auto refusal = [](const std::string& head, const std::string& follow) {
    const Testbed testbed = parse_testbed("t.toml", row_of_cameras(1, head) + "[follow]\n" + follow);
    return refusal_of([&] { Positioning positioning(testbed, 1); });
  };
  const std::string head = "dictionary = \"aruco_4x4_50\"\n";
  expect_in("[follow] has no tags", refusal(head, ""));
  expect_in("the ids 0 to 49", refusal(head, "tags = [50]"));
  expect_in("the ids 0 to 49", refusal(head, "tags = [1]\nstop = \"tag 50 enters [0 0 1 1]\""));
  expect_in("only_listed", refusal(head + "only_listed = true\n", "tags = [1]"));
  expect_in("no camera sees the rectangle", refusal(head, "tags = [1]\nstart = \"tag 1 enters [5 5 1 1]\""));
}

TEST(Follow, ReadsListsOfTags) {
  EXPECT_EQ(read_tags("7,9,7"), (std::set<std::uint32_t>{7, 9}));
  EXPECT_EQ(read_tags("65535"), (std::set<std::uint32_t>{65535}));
  for (const char* wrong : {"", ",", "7,", ",7", "7;9", "-7", "65536", "000007", "7, 9", "x"})
    EXPECT_TRUE(read_tags(wrong).empty()) << wrong;
}

/// A region contains the tag and `kRegionMargin` around it: each number of its fit is that of the whole image, though
/// other tags, and parts of them, are in the region or not.
TEST(Follow, TagsInRegionsAreThoseOfTheWholeImage) {
  for (const char* dictionary : {"apriltag_36h11", "aruco_4x4_50", "artoolkitplus_bch"}) {
    const Testbed testbed =
        parse_testbed("t.toml", row_of_cameras(1, fmt::format("dictionary = \"{}\"\n", dictionary)));
    const int cells = family_pattern(dictionary, 0).cells;
    std::vector<TrueTag> tags;
    for (std::uint32_t i = 0; i < 8; ++i)
      tags.push_back({i + 1, {-0.55 + 0.36 * (i % 4), i < 4 ? 0.3 : -0.25, 0.2, 0.9 * i}, {0.3, 0.2 * i}, 0.5});
    FollowStage stage(testbed, tags);
    const Camera& camera = testbed.cameras[0].camera;
    const Frame& frame = stage.images(0.1)[0];
    const Region whole_image = vision::whole(frame.image);
    TagDetector full(testbed, camera), part(testbed, camera);
    std::vector<Sighting> all, one;
    full.detect(frame.image, frame.time, all);
    ASSERT_GE(all.size(), 7u) << dictionary;
    for (const Sighting& sighting : all) {
      Search search;
      const glm::dvec2 at{sighting.fit.X_WT.x, sighting.fit.X_WT.y};
      add_region(camera, {at, glm::dvec2{0.01}, 0.2}, testbed.tag, cells, search);
      ASSERT_EQ(search.regions.size(), 1u);
      EXPECT_LT(search.regions[0].area(), whole_image.area() / 6);
      part.detect(frame.image, frame.time, search, {sighting.id}, one);
      ASSERT_EQ(one.size(), 1u) << dictionary << " " << sighting.id;
      EXPECT_EQ(one[0].time, sighting.time);
      EXPECT_TRUE(has_same_bits(one[0].fit, sighting.fit)) << dictionary << " " << sighting.id;
    }
  }
}

/// One tag crosses three cameras between others: in each image its pose is that of a search of all images.
TEST(Follow, FollowedTagsHaveThePosesOfAFullSearch) {
  const Testbed all = parse_testbed("t.toml", row_of_cameras(3));
  Testbed following = all;
  following.follow.emplace().tags = {3};
  FollowStage stage(all, {{3, {-0.4, 0.1, 0.2, 0.3}, {2.0, 0.0}, 0.4},
                          {1, {0.0, -0.3, 0.2, 0.0}, {}, 0.0},
                          {2, {1.3, 0.4, 0.2, 0.0}, {0.1, 0.0}, 0.0}});
  Positioning full(all, 1), followed(following, 1);
  int seen = 0, both = 0;
  for (int i = 0; i < 24; ++i) {
    const auto frames = stage.images(i / 15.0);
    const auto some = followed.update(frames);
    for (const TrackedTag& tag : full.update(frames)) {
      if (tag.id != 3) continue;
      ASSERT_EQ(some.size(), 1u) << i;
      EXPECT_TRUE(has_same_bits(some[0], tag)) << i;
      ++seen;
      both += tag.cameras == 2 ? 1 : 0;
    }
  }
  EXPECT_EQ(seen, 24);
  EXPECT_GE(both, 1) << "in the overlap, both cameras search";
  const FollowCounts& counts = followed.follower()->counts();
  EXPECT_EQ(counts.tags.at(3).hand_overs, 2u);
  EXPECT_EQ(counts.tags.at(3).seen, 24u);
  EXPECT_EQ(counts.tags.at(3).unseen, 0u);
  EXPECT_LT(counts.tags.at(3).longest_gap, 0.07);
  for (const CameraUse& use : counts.cameras) {
    EXPECT_EQ(use.images(), 24u);
    EXPECT_EQ(use.whole, 1u) << "the first image, to find it";
    EXPECT_GE(use.asleep, 8u);
    EXPECT_LT(use.share(), 0.25);
  }
  EXPECT_EQ(followed.counts().images, 72u);
  EXPECT_GE(followed.counts().asleep, 33u);
  EXPECT_GE(followed.counts().unwanted, 1u) << "the other tags are in the first images";
}

/// The measured height and tilt select the parts then.
TEST(Follow, TagsWithMeasuredTiltsAreFollowedToo) {
  const Testbed all = parse_testbed("t.toml", row_of_cameras(2, "dictionary = \"aruco_4x4_50\"\ntag_fit = \"tilt\"\n"));
  Testbed following = all;
  following.follow.emplace().tags = {3};
  FollowStage stage(all, {{3, {0.3, 0.1, 0.4, 0.3}, {1.5, 0.0}, 0.4}, {1, {0.0, -0.3, 0.2, 0.0}, {}, 0.0}});
  Positioning full(all, 1), followed(following, 1);
  for (int i = 0; i < 8; ++i) {
    const auto frames = stage.images(i / 15.0);
    const auto some = followed.update(frames);
    const auto tags = full.update(frames);
    const auto expected = std::find_if(tags.begin(), tags.end(), [](const TrackedTag& tag) { return tag.id == 3; });
    ASSERT_NE(expected, tags.end()) << i;
    ASSERT_EQ(some.size(), 1u) << i;
    EXPECT_TRUE(has_same_bits(some[0], *expected)) << i;
    EXPECT_NEAR(some[0].X_WT.z, 0.4, 0.03);
  }
  EXPECT_LT(followed.follower()->counts().cameras[0].share(), 0.5);
}

/// Covered for longer than `search`: found again with the first search of its camera's turn.
TEST(Follow, LostTagsAreSearchedInTurn) {
  Testbed testbed = parse_testbed("t.toml", row_of_cameras(3));
  testbed.follow.emplace().tags = {3};
  FollowStage stage(testbed, {{3, {2.6, 0.1, 0.2, 0.3}, {}, 0.0}});
  Positioning positioning(testbed, 1);
  std::size_t i = 0;
  std::vector<std::size_t> seen;
  for (; i < 30; ++i)
    if (const bool covered = i >= 3 && i < 24;
        !positioning.update(stage.images(0.1 * static_cast<double>(i), covered)).empty())
      seen.push_back(i);
  ASSERT_GE(seen.size(), 4u);
  EXPECT_EQ(seen[2], 2u);
  EXPECT_GE(seen[3], 24u);
  EXPECT_LE(seen[3], 26u) << "each of three cameras is searched in one of three images";
  EXPECT_EQ(seen.back(), 29u);
  const FollowCounts& counts = positioning.follower()->counts();
  EXPECT_NEAR(counts.tags.at(3).longest_gap, 0.1 * static_cast<double>(seen[3] - seen[2]), 1e-9);
  EXPECT_GE(counts.cameras[0].asleep, 8u) << "while the tag is seen, at first while it is not, and in turn";
}

TEST(Follow, EventsStartAndStopIt) {
  FollowWatch watch("tags = [7]\nstart = \"tag 3 enters [0.9 -0.4 0.5 0.8]\"\nstop = \"tag 7 leaves [-1 -1 3 2]\"\n");
  watch.step(3, 0.0, 0);
  EXPECT_EQ(watch.needed(), 1) << "only the camera that sees the rectangle searches, and only there";
  EXPECT_FALSE(watch.searches[1].whole);
  EXPECT_TRUE(watch.follower.followed().empty());
  watch.step(3, 0.8, 1);
  EXPECT_TRUE(watch.tracked.empty()) << "the tag of an event is not reported";
  watch.step(3, 0.95, 1);
  EXPECT_EQ(watch.follower.followed(), (std::set<std::uint32_t>{7}));
  EXPECT_EQ(watch.follower.counts().starts, 1u);
  watch.step(7, 1.5, 1);
  ASSERT_EQ(watch.tracked.size(), 1u);
  EXPECT_EQ(watch.tracked[0].id, 7u);
  EXPECT_EQ(watch.needed(), 2) << "tag 7 is searched for in all cameras";
  watch.step(7, 1.9, 1);
  EXPECT_EQ(watch.needed(), 1);
  watch.step(7, 2.05, 1);
  EXPECT_EQ(watch.follower.counts().stops, 1u);
  EXPECT_TRUE(watch.tracked.empty());
  EXPECT_FALSE(watch.follower.is_over()) << "tag 3 may enter again";
  watch.step(3, 1.0, 1);
  EXPECT_EQ(watch.follower.counts().starts, 2u);
}

TEST(Follow, ATimeStartsAndStopsItOnce) {
  FollowWatch watch("tags = [7]\nstart = \"at 0.15 s\"\nstop = \"at 0.35 s\"\n");
  std::vector<int> needed;
  for (int i = 0; i < 6; ++i) {
    watch.step(7, -0.4, 0);
    needed.push_back(watch.needed());
  }
  EXPECT_EQ(needed, (std::vector<int>{0, 0, 2, 1, 0, 0}));
  EXPECT_TRUE(watch.follower.is_over());
}

/// Images are read in time for a start at a time.
TEST(Follow, CamerasWakeForAStart) {
  Testbed testbed = parse_testbed("t.toml", row_of_cameras(1) + "[follow]\ntags = [3]\nstart = \"at 0.5 s\"\n");
  testbed.cameras[0].camera.rate = 10.0;
  FollowStage stage(testbed, {{3, {0.0, 0.1, 0.2, 0.3}, {}, 0.0}});
  Positioning positioning(testbed, 1);
  for (int i = 0; i < 7; ++i) {
    const bool asleep = positioning.asleep()[0] != 0;
    EXPECT_EQ(asleep, i > 0 && i < 4) << i;
    std::vector<Frame> frames(1);
    frames[0].time = 0.1 * i;
    frames[0].unread = asleep;
    if (!asleep) frames[0].image = stage.images(0.1 * i)[0].image;
    EXPECT_EQ(positioning.update(frames).size(), i < 5 ? 0u : 1u) << i;
  }
}

/// A stop at a time is final, also if following has not begun.
TEST(Follow, ATimeEndsTheWaitForAStart) {
  FollowWatch watch("tags = [7]\nstart = \"tag 3 enters [0 -0.4 0.5 0.8]\"\nstop = \"at 0.15 s\"\n");
  for (int i = 0; i < 2; ++i) watch.step(7, 0.0, 0);
  EXPECT_EQ(watch.needed(), 1);
  EXPECT_FALSE(watch.follower.is_over());
  watch.step(3, 0.1, 0);
  EXPECT_EQ(watch.needed(), 0);
  EXPECT_TRUE(watch.follower.is_over());
  EXPECT_EQ(watch.follower.counts().starts, 0u);
}

/// A camera without images does not keep the others awake.
TEST(Follow, AbsentCamerasAreNotWaitedFor) {
  FollowWatch watch("tags = [7]\n", 3);
  watch.absent[1] = 1;
  std::vector<int> needed;
  for (int i = 0; i < 4; ++i) {
    watch.step(7, 0.0, 0, false);
    needed.push_back(watch.needed());
  }
  EXPECT_EQ(needed, (std::vector<int>{2, 0, 1, 1})) << "the second camera's turn is without an image";
}

/// The same tag and rectangle start and stop it: each change needs a new entrance.
TEST(Follow, ATagInsideDoesNotEnterAgain) {
  const std::string event = "\"tag 7 enters [0.9 -0.4 0.5 0.8]\"";
  FollowWatch watch("tags = [7]\nstart = " + event + "\nstop = " + event + "\n");
  for (int i = 0; i < 4; ++i) watch.step(7, 1.1, 1);
  EXPECT_EQ(watch.follower.counts().starts, 1u);
  EXPECT_EQ(watch.follower.counts().stops, 0u);
  watch.step(7, 0.8, 1);
  watch.step(7, 1.0, 1);
  EXPECT_EQ(watch.follower.counts().stops, 1u);
}

TEST(Follow, SaysWhatHappensAtABoundedRate) {
  FollowWatch watch("tags = [7]\n");
  std::size_t messages = 0;
  for (int i = 0; i < 100; ++i) {
    watch.step(7, 0.65, static_cast<std::size_t>(i / 2 % 2));
    messages += watch.follower.messages().size();
  }
  EXPECT_EQ(watch.follower.counts().tags.at(7).hand_overs, 49u);
  EXPECT_LE(messages, 11u);
  EXPECT_GE(messages, 9u);
}

/// A camera counts as asleep before its next image only if neither that nor the following one will be searched.
TEST(Follow, CamerasThatSleepNeedNotBeRead) {
  const Testbed all = parse_testbed("t.toml", row_of_cameras(3));
  Testbed following = all;
  following.follow.emplace().tags = {3};
  FollowStage stage(all, {{3, {-0.4, 0.1, 0.2, 0.3}, {2.0, 0.0}, 0.4}});
  Positioning full(all, 1), followed(following, 1);
  std::uint64_t unread = 0;
  for (int i = 0; i < 24; ++i) {
    const auto images = stage.images(i / 15.0);
    std::vector<Frame> frames(images.begin(), images.end());
    for (std::size_t k = 0; k < frames.size(); ++k) {
      if (followed.asleep()[k] == 0) continue;
      frames[k].image.pixels.clear();
      frames[k].unread = true;
      ++unread;
    }
    const auto expected = full.update(images);
    const auto tags = followed.update(frames);
    ASSERT_EQ(tags.size(), 1u) << i;
    EXPECT_TRUE(has_same_bits(tags[0], expected[0])) << i;
  }
  EXPECT_GE(unread, 30u);
  std::uint64_t counted = 0;
  for (const CameraUse& use : followed.follower()->counts().cameras) counted += use.unread;
  EXPECT_EQ(counted, unread);
  EXPECT_EQ(followed.counts().unreadable, 0u);
}

}  // namespace sf::vision
