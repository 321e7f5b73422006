#pragma once
/// The light of a room where a camera sees matt surfaces, with its error: at places that are receivers of a RigLight, and
/// over its picture between them.
///
/// Between places the light is traced in the room as it was found to be, times what the places around say it is over
/// that; its error, relative, is that of the places around, by 1 / (distance² + (15 cm)²)², those that face elsewhere
/// hardly counted.

#include <Eigen/Core>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/calibration/lamp_steps.h"
#include "core/calibration/rig_light.h"
#include "core/calibration/seen_places.h"
#include "core/picture/picture.h"
#include "core/run.h"
#include "core/tasks/session.h"

namespace luxrig {

/// What each fixture gives, over its light at level 1. error: standard error of that, relative, as its dimmer has it.
struct LampShares {
  Eigen::VectorXd share, error;
};
/// level: per fixture, as sent. curves: per fixture; of a lamp without one the dimmer is known where it was read, and less
/// well the farther from there: dimmer_exponent as in LightPriors.
[[nodiscard]] LampShares lamp_shares(const LightUnknowns& known, std::span<const LampCurve> curves,
                                     std::span<const double> level, double dimmer_exponent);

struct LuxMap {
  struct Place {
    std::string point;  ///< of the rig; empty = at none
    Vec3 position_world_m = Vec3::Zero(), normal_world = Vec3::UnitZ();
    double x_px = 0, y_px = 0;  ///< in the camera's picture
    LightEstimate light;
  };
  std::string camera;
  std::string light;                                   ///< which light it is, for a person: "the look in force"
  std::vector<std::pair<std::string, double>> shares;  ///< of full light, by the fixture's name; dark ones are left out
  std::vector<Place> places;
  std::string lux_png, error_png;  ///< the files of both pictures; empty = none
};

/// Those of the places that the camera shows. The receivers of `light` from first_receiver on are at them.
[[nodiscard]] std::vector<LuxMap::Place> map_places(const Rig& rig, const RigLight& light, const Camera& camera,
                                                    std::span<const SeenPlace> places, std::size_t first_receiver,
                                                    const LampShares& shares);

/// Over a picture: illuminance_lx holds lux, and percent of that; negative where the camera sees no matt surface.
struct LuxMapPictures {
  Picture lux, error_percent;
};

/// found: the rig as it was found to be. camera: as found, at most 16384 pixels each way; the picture is as small as
/// fits a page. Cause::cancelled when stopped.
[[nodiscard]] Result<LuxMapPictures> map_pictures(const Session& found, const Camera& camera,
                                                  std::span<const LuxMap::Place> places, const Eigen::VectorXd& share,
                                                  const Run& run);

}  // namespace luxrig
