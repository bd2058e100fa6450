// Every key in the tables of world/fields.h must be known, read, hashed, and kept by snapshots.

#include "world/fields.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <type_traits>

#include "base/error.h"
#include "tests/world/read_world.h"
#include "world/keys.h"

namespace sf::world {
namespace {

/// A world file with one row of the type, and the position of its keys in the file.
template <class Row>
struct Example {
  KeyScope where;
  std::string before;
  std::string after;
  Row& (*row)(World&);

  World read(const std::string& keys) const { return read_world(before + keys + after); }
};

const Example<World> kWorlds{KeyScope::world, "", " model( )", [](World& w) -> World& { return w; }};
const Example<Segment> kSegments{KeyScope::model, "model( ", " )", [](World& w) -> Segment& { return w.walls.at(0); }};
const Example<Emitter> kEmitters{KeyScope::model, "define wall model( ir_emitter \"virtual_wall\" ) wall( ", " )",
                                 [](World& w) -> Emitter& { return w.emitters.at(0); }};
const Example<Fiducial> kFiducials{KeyScope::model, "define mark model( fiducial_return 1 ) mark( ", " )",
                                   [](World& w) -> Fiducial& { return w.fiducials.at(0); }};
const Example<Lamp> kLamps{KeyScope::model, "define lamp model( lamp_intensity 1 ) lamp( ", " )",
                           [](World& w) -> Lamp& { return w.lamps.at(0); }};
const Example<HeatSource> kHeat{KeyScope::model, "define stove model( heat 1 ) stove( ", " )",
                                [](World& w) -> HeatSource& { return w.heat_sources.at(0); }};
const Example<Light> kLights{KeyScope::light, "light( phases 1 phase[0] [\"red\" 1] ", " )",
                             [](World& w) -> Light& { return w.lights.at(0); }};
const Example<Mover> kMovers{KeyScope::position, "position( ", " )", [](World& w) -> Mover& { return w.movers.at(0); }};

/// Returns a value other than `value`, within the bounds of every field.
template <class T>
T other(const T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    return !value;
  } else if constexpr (std::is_enum_v<T>) {
    return static_cast<T>((static_cast<std::size_t>(value) + 1) % words_of(value).size());
  } else if constexpr (std::is_same_v<T, std::string>) {
    return value + "2";
  } else {
    return T(2);
  }
}

template <class T>
std::string written(const T& value) {
  if constexpr (std::is_same_v<T, std::string>) {
    return '"' + value + '"';
  } else if constexpr (std::is_enum_v<T>) {
    return fmt::format("\"{}\"", words_of(value).at(static_cast<std::size_t>(value)));
  } else {
    return fmt::format("{:d}", static_cast<int>(value));
  }
}

template <class T>
constexpr bool kHasKeys = std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, std::string>;

/// Calls `check(example, field, value)` for each key. @param value of the field if the file lacks the key
template <class Check>
void for_each_key_of_all(Check check) {
  int keys = 0;
  const auto walk = [&]<class Row>(const Example<Row>& example) {
    World world = example.read("");
    const Row& row = example.row(world);
    for_each_key<Row>([&](const auto& field) {
      using T = std::remove_cvref_t<decltype(row.*field.member)>;
      SCOPED_TRACE(field.key.name);
      ++keys;
      if constexpr (kHasKeys<T>) {
        check(example, field, row.*field.member);
      } else {
        ADD_FAILURE() << "a key for a field of a type without a reader";
      }
    });
  };
  walk(kWorlds);
  walk(kSegments);
  walk(kEmitters);
  walk(kLamps);
  walk(kHeat);
  walk(kFiducials);
  walk(kLights);
  walk(kMovers);
  EXPECT_GE(keys, 24) << "the walk found all tables";
}

TEST(Fields, EveryKeyIsKnownSuggestedAndRead) {
  for_each_key_of_all([](const auto& example, const auto& field, const auto& value) {
    const std::string key(field.key.name);
    EXPECT_TRUE(is_known_key(example.where, key));
    EXPECT_EQ(suggest_key(example.where, key + "x"), "; did you mean '" + key + "'?");
    std::string text = written(other(value));
    if (!field.key.tuple.empty()) text = fmt::format("[{0} {0} {0} {0} {0} {0} {0} {0}]", text);
    World world = example.read(key + " " + text);
    EXPECT_NE(example.row(world).*field.member, value) << text;
    EXPECT_EQ(warnings_of(world), warnings_of(example.read("")));
  });
}

TEST(Fields, EveryKeyIsHashedAndKeptBySnapshots) {
  for_each_key_of_all([](const auto& example, const auto& field, const auto& value) {
    World world = example.read("");
    const std::uint64_t hash = world.hash;
    example.row(world).*field.member = other(value);
    update_extent_and_hash(world);
    EXPECT_EQ(world.hash != hash, field.role == Role::physics);
    World again = from_snapshot(snapshot(world));
    EXPECT_EQ(example.row(again).*field.member, other(value));
  });
}

TEST(Fields, ValuesOutOfBoundsAreRejected) {
  for_each_key_of_all([](const auto& example, const auto& field, const auto& value) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, double>) {
      const double least = std::min(-1.0, 2.0 * field.bounds.least);
      std::string text = fmt::format("{}", least);
      if (!field.key.tuple.empty()) text = fmt::format("[{0} {0} {0} {0} {0} {0} {0} {0}]", text);
      const std::string error =
          error_of(fmt::format("{}\n{} {}{}", example.before, field.key.name, text, example.after));
      EXPECT_TRUE(error.starts_with("test.world:2: ")) << error;
      EXPECT_NE(error.find("expected"), std::string::npos) << error;
      for (const double bad : {least, std::nan("")}) {
        World world = example.read("");
        example.row(world).*field.member = bad;
        update_extent_and_hash(world);
        EXPECT_THROW(from_snapshot(snapshot(world)), base::InputError) << bad;
      }
    }
  });
}

}  // namespace
}  // namespace sf::world
