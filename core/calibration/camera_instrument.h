#pragma once
/// A camera as an instrument of LightUnknowns. What it shows of a place is the light there
///   × true over stated reflectance of the paint, which is the room's paint unknown too, and a little of its own;
///   × its response to each kind of lamp over the eye's: published factors of one camera range over 1 to 3, so a single
///     scale will not do;
///   × e^(-(a ρ² + b ρ⁴ + c ρ⁶)) of the lens, ρ = 1 in a corner;
///   + stray light: shares of the picture's mean, and of what is around.
///
/// None of the factors says how bright a lux is: at least one reading of a luxmeter has to, for each kind of lamp.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/light_unknowns.h"
#include "core/calibration/seen_places.h"
#include "core/estimation/calibration.h"
#include "core/rig/rig.h"

namespace luxrig {

/// Standard deviations of what is not known of a camera.
struct CameraPriors {
  double log_response = 0.5;         ///< per kind of lamp
  double lens[3] = {0.5, 0.3, 0.2};  ///< a, b, c
  double log_paint = 0.02;           ///< of a material as seen, beside its reflectance: gloss, texture
  double flare = 0.02, halo = 0.02;  ///< shares
  double place_share = 0.015;        ///< of a reading: paint that is not the same all over
};

/// Shares of a goal's variance, by what it is owed to.
struct CameraBudget {
  double lens = 0, stray = 0, response = 0, reflectance = 0, lamps = 0, noise = 0, other = 0;
};
struct CameraBudgetPart {
  const char* words;  ///< for a person
  const char* key;    ///< in JSON
  double CameraBudget::*share;
};
inline constexpr CameraBudgetPart kCameraBudgetParts[] = {
    {"lamps and mounts", "lamps", &CameraBudget::lamps},
    {"the camera's response to each kind of lamp", "response", &CameraBudget::response},
    {"paint", "paint", &CameraBudget::reflectance},
    {"lens", "lens", &CameraBudget::lens},
    {"stray light in it", "stray", &CameraBudget::stray},
    {"noise", "noise", &CameraBudget::noise},
    {"all else", "other", &CameraBudget::other}};

class CameraInstrument {
 public:
  /// Adds the camera's unknowns to the priors, after those of all luxmeters.
  CameraInstrument(const Rig& rig, std::size_t materials, LightPriors& priors, const CameraPriors& usual = {});

  /// How it shows a place. places, light: in the same order, by pictures of this size; none = not seen.
  /// first_receiver: of the first place. level: of the lamps that were lit. Readings that say little are left out.
  [[nodiscard]] std::vector<LightReading> readings(std::span<const std::optional<SeenPlace>> places,
                                                   std::span<const std::optional<SeenLight>> light, int width_px,
                                                   int height_px, std::size_t first_receiver,
                                                   const Eigen::VectorXd& level) const;
  /// Instrument of LightPriors::log_meter: its response to a luminaire of the rig.
  [[nodiscard]] std::size_t response_to(std::size_t luminaire) const { return first_response_ + luminaire; }
  /// What the lens lets through, over that in the middle. rho: of the way to a corner.
  [[nodiscard]] double lens_share(const LightUnknowns& known, double rho) const;
  /// Lens, stray light, and responses to the kinds of lamps that readings told something of; the rest stays.
  void put(const Rig& rig, const LightUnknowns& known, CalibratedCamera& into) const;

 private:
  friend CameraBudget budget_of(const LightBudget& budget, std::span<const CameraInstrument* const> cameras);
  [[nodiscard]] Showing showing(const SeenPlace& place, const SeenLight& light, int width_px, int height_px) const;

  CameraPriors usual_;
  std::size_t first_paint_, first_lens_, first_response_, responses_, first_stray_;
  std::vector<std::size_t> of_lamp_;
};

/// cameras: all that the light was read by.
[[nodiscard]] CameraBudget budget_of(const LightBudget& budget, std::span<const CameraInstrument* const> cameras);
/// Mean over the goals; none = the rig has no goal.
[[nodiscard]] std::optional<CameraBudget> budget_of_goals(const Rig& rig, const LightUnknowns& known,
                                                          const Eigen::VectorXd& level,
                                                          std::span<const CameraInstrument* const> cameras);

}  // namespace luxrig
