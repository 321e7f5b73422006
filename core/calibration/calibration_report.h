#pragma once
/// What a calibration found, for a person who wants to know whether to believe it: what was wrong before, what is known
/// now, how well the readings agree, what could not be found out, and which measurement would settle it.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/calibration/camera_instrument.h"
#include "core/calibration/camera_run.h"
#include "core/calibration/lux_map.h"
#include "core/calibration/rig_light.h"
#include "core/estimation/calibration.h"

namespace luxrig {

/// A reading so many standard errors off is told of.
inline constexpr double kOddReading = 4;

struct CalibrationReport {
  struct Goal {
    std::string point;
    LightEstimate stated;  ///< before anything was measured
    LightEstimate found;
  };
  struct Reading {
    std::string light, at;    ///< "spot-3" alone at level 0.62; the point or luxmeter
    double lux = 0;           ///< without the dark
    double explained_lx = 0;  ///< by what is known now
    double in_errors = 0;     ///< how far off, in standard errors of both
  };
  struct SeenBy {
    std::string camera;
    CameraOverflow overflow;
  };

  Calibration found;
  std::vector<std::string> by;  ///< what measured: "luxmeters that hang"
  double level = 0;             ///< of every lamp, for the light at the goals
  std::vector<Goal> goals;
  std::vector<Reading> readings;
  std::vector<std::string> not_found;  ///< a sentence each
  std::vector<std::string> to_settle;  ///< points where a luxmeter would settle most of the rest, best first
  std::vector<SeenBy> seen{};          ///< each camera that measured
  /// With a camera: of the light at the goals; none = the rig has no goal.
  std::optional<CameraBudget> variance{};
  std::vector<LuxMap> maps{};  ///< of what the cameras see
};

/// before, now: the light before and after it was measured, of this session. level: share of full light of every lamp at
/// the goals. no_points: points that no luxmeter can be held at, such as a camera's places.
[[nodiscard]] CalibrationReport report_of(const Session& session, const RigLight& before, const RigLight& now,
                                          Calibration found, double level, std::span<const std::size_t> no_points);

/// JSON, "luxrig_calibration_report": 2. The same value gives the same bytes.
[[nodiscard]] std::string to_json(const CalibrationReport& report);
/// One page without scripts or other files.
[[nodiscard]] std::string to_html(const CalibrationReport& report);

}  // namespace luxrig
