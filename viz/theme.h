#pragma once
// Colours and line widths of figures; for colour scales see viz/color.h. Colours are ARGB. Curves use the colours of
// Okabe and Ito (2002), which remain distinct for colour-blind readers.

#include <array>
#include <cstdint>

namespace sf::viz::theme {

// Paper and text
inline constexpr std::uint32_t kNone = 0x00000000u;
inline constexpr std::uint32_t kWhite = 0xFFFFFFFFu;
inline constexpr std::uint32_t kBlack = 0xFF000000u;
inline constexpr std::uint32_t kNeutral = 0xFF808080u;
inline constexpr std::uint32_t kInk = 0xFF202020u;
inline constexpr std::uint32_t kLabel = 0xFF505050u;
inline constexpr std::uint32_t kMinorLabel = 0xFF707070u;
inline constexpr std::uint32_t kLegendText = 0xFF303030u;
inline constexpr std::uint32_t kLeader = 0xB0606060u;  ///< from a label to its mark
inline constexpr std::uint32_t kInsetTie = 0x90404040u;

// Axes and curves
inline constexpr std::uint32_t kFrame = 0xFF404040u;
inline constexpr std::uint32_t kGridLine = 0x28808080u;
inline constexpr std::uint32_t kZeroLine = 0x60808080u;
inline constexpr std::uint32_t kBlue = 0xFF0072B2u;
inline constexpr std::uint32_t kVermillion = 0xFFD55E00u;
inline constexpr std::array<std::uint32_t, 7> kSeries{kBlue,       kVermillion, 0xFF009E73u, 0xFFCC79A7u,
                                                      0xFFE69F00u, 0xFF56B4E9u, kBlack};
inline constexpr std::uint32_t kNoReading = 0xFF9A9A9Au;  ///< hatching where nothing was measured
inline constexpr std::uint32_t kDominated = 0xFF909090u;  ///< modes that are not Pareto-optimal
inline constexpr std::uint32_t kReferencePath = kNeutral;
inline constexpr std::uint32_t kMapInk = 0xFF15181Cu;   ///< marks on a colour map
inline constexpr std::uint32_t kMapHalo = 0x90FFFFFFu;  ///< their border, visible on dark colours

// World
inline constexpr std::uint32_t kWall = 0xFF64707Du;
inline constexpr std::uint32_t kQuietWall = 0xFFB4BAC2u;   ///< behind trajectories
inline constexpr std::uint32_t kUnseenWall = 0xFF9A9A9Au;  ///< invisible to lasers
inline constexpr std::uint32_t kFloorHole = 0xFF2B2B33u;
inline constexpr std::uint32_t kMagnetUp = 0xFFC62828u;
inline constexpr std::uint32_t kMagnetDown = 0xFF1565C0u;
inline constexpr std::uint32_t kMagnetometer = 0xFF6A1B9Au;
inline constexpr std::uint32_t kFieldOfView = 0xFFEF6C00u;
inline constexpr std::uint32_t kVirtualWall = 0xFF8E24AAu;
inline constexpr std::uint32_t kRedBuoy = 0xFFD32F2Fu;
inline constexpr std::uint32_t kGreenBuoy = 0xFF2E7D32u;
inline constexpr std::uint32_t kForceField = 0xFF455A64u;
inline constexpr std::uint32_t kLightRed = 0xFFE53935u;
inline constexpr std::uint32_t kLightYellow = 0xFFFDD835u;
inline constexpr std::uint32_t kLightGreen = 0xFF43A047u;
inline constexpr std::uint32_t kLightOff = 0xFF616161u;

// Robots
inline constexpr std::uint32_t kTag = 0xFFC2187Bu;
inline constexpr std::uint32_t kCar = 0xFF1F6FB4u;
inline constexpr std::uint32_t kOtherRobot = kTag;
inline constexpr std::uint32_t kContact = 0xFFD4351Cu;

// Roads
inline constexpr std::uint32_t kRoadGround = 0xFFF3F1EAu;
inline constexpr std::uint32_t kAsphalt = 0xFF7C8188u;
inline constexpr std::uint32_t kAsphaltBand = 0xFFC3C8CEu;  ///< below lane markings
inline constexpr std::uint32_t kLaneEdge = 0xFFB4B8BDu;
inline constexpr std::uint32_t kZone = 0xFFDDE6D5u;
inline constexpr std::uint32_t kZoneEdge = 0xFF6E8B5Au;
inline constexpr std::uint32_t kZoneText = 0xFF36522Au;
inline constexpr std::uint32_t kSpot = 0xFFC3CFB8u;
inline constexpr std::uint32_t kExit = 0x9A1F6FB4u;
inline constexpr std::uint32_t kStop = 0xFFD7191Cu;
inline constexpr std::uint32_t kCheckpoint = 0xFF7A1FA2u;

// Occupancy maps: unknown, occupied, free, and conflict where maps contradict each other
inline constexpr std::array<std::uint32_t, 4> kThesisMapStates{0xFF474B50u, 0xFF1748D1u, 0xFFFFFFFFu, 0xFFFF00FFu};
inline constexpr std::array<std::uint32_t, 4> kRosMapStates{0xFFCDCDCDu, 0xFF000000u, 0xFFFEFEFEu, 0xFFFF00FFu};
inline constexpr std::uint32_t kMapGrid = 0xFFA9AEB5u;
inline constexpr std::uint32_t kCellBorder = 0xFF8A8F96u;

// Line widths [pixel]
inline constexpr double kHairline = 1.0;  ///< frames, ticks, grids
inline constexpr double kOutline = 1.5;
inline constexpr double kCurve = 2.0;
inline constexpr double kBold = 2.5;

/// Dash patterns of curves by row: on, off, ... [px]; the round ends make each dash one line width longer.
inline constexpr double kDashed[] = {11.0, 7.0};
inline constexpr double kDotted[] = {0.1, 5.0};
inline constexpr double kDashDot[] = {13.0, 6.0, 0.1, 6.0};
inline constexpr double kLongDashed[] = {20.0, 8.0};
inline constexpr double kDashDotDot[] = {11.0, 5.0, 0.1, 5.0, 0.1, 5.0};
inline constexpr double kShortDashed[] = {5.0, 6.0};

}  // namespace sf::viz::theme
