#pragma once
// Table of the ray casters, one line each, and selection by name.

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sf::raycast {

class Caster;
struct CasterInputs;

/// Description and factory of one ray caster.
struct CasterType {
  std::string_view name;     ///< argument of `--caster`
  std::string_view summary;  ///< for the help text
  bool on_device = false;    ///< its kernels need a Vulkan device
  /// Ranges are bit-identical to those of `intersect` (raycast/intersect.h), so all casters with this flag return the
  /// same bytes. Other casters agree with them within the sum of both bounds, except for beams that pass the end of a
  /// surface within that sum.
  bool same_bytes = true;
  /// Returns a description for reports: the name and the hardware, such as "host, AVX2".
  std::string (*describe)();
  /// Returns the largest error [m] of the range of a beam that does not graze a surface, without `single`. Parameters
  /// as for `exact_bound`.
  double (*bound)(double range_max, double longest, double farthest);
  std::unique_ptr<Caster> (*make)(const CasterInputs& in);
};

// All casters, in the order of help texts. Each is defined in the source file of the same name.
// clang-format off
#define SF_CASTERS(caster) \
  caster(device_caster)    \
  caster(host_caster)      \
  caster(reference_caster)
// clang-format on

#define SF_DECLARE_CASTER(name) extern const CasterType name;
SF_CASTERS(SF_DECLARE_CASTER)
#undef SF_DECLARE_CASTER

std::span<const CasterType* const> casters();

/// Returns the arguments of `--caster`: "auto", then the names of all casters.
std::vector<std::string> caster_words();

/// Returns the caster of that name; null for "auto". @throws base::InputError for other words, with `where` as prefix
const CasterType* caster_named(std::string_view word, std::string_view where = "");

/// Returns `asked` if not null; otherwise the caster named by the environment variable SENSORFARM_CASTER. If that is
/// unset or "auto", returns the host's caster on a software device, where it is faster, and else the device's.
/// @throws base::InputError if SENSORFARM_CASTER is not the name of a caster
const CasterType& choose_caster(bool software, const CasterType* asked = nullptr);

/// Returns the description of the chosen caster for reports.
std::string describe_caster(bool software, const CasterType* asked = nullptr);

}  // namespace sf::raycast
