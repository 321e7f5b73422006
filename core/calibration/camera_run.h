#pragma once
/// Lamps one after the other before a camera: which light to photograph next, and what follows from the pictures. It
/// neither lights nor photographs anything itself.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/calibration/camera_instrument.h"
#include "core/calibration/camera_pose.h"
#include "core/calibration/exposures.h"
#include "core/calibration/lamp_steps.h"
#include "core/calibration/seen_places.h"
#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"

namespace luxrig {

/// Where a camera is looked for: where an earlier calibration found it, and, if it is not there, where the rig file has
/// it. Both of one size.
struct CameraStart {
  Camera stated;
  std::optional<Camera> found_before{};
  [[nodiscard]] const Camera& best() const { return found_before ? *found_before : stated; }
};

/// What was left out of the lamps' pictures, as even the shortest exposure was full there.
struct CameraOverflow {
  double pixel_share = 0;                   ///< of all lamps' pictures
  std::size_t places = 0, full_places = 0;  ///< seen under the lamps; of these, left out
};

class CameraRun {
 public:
  /// rig, rays and places outlive it. rays, places: as in the rig file. brightest: brightest_levels(); lamps at 0 are
  /// not measured. curves: per fixture; those that are empty are read from pictures at a few levels.
  CameraRun(const Rig& rig, const RayScene& rays, CameraStart start, std::span<const SeenPlace> places,
            std::span<const double> brightest, std::vector<LampCurve> curves);

  /// Levels of all fixtures that are to be photographed now; none = all is. First most of the room at once, by which the
  /// camera is found; then the dark; then each lamp alone. Runs of several cameras that begin with the same levels and
  /// curves ask for the same.
  [[nodiscard]] std::optional<std::vector<double>> next() const;
  [[nodiscard]] std::string words_of_next() const;
  /// The lamp that is lit alone then.
  [[nodiscard]] std::optional<std::size_t> lamp_of_next() const;
  [[nodiscard]] std::size_t steps() const { return 1 + plan_.size(); }
  [[nodiscard]] std::size_t done() const { return taken_.size() + (found_ ? 1 : 0); }
  /// The picture under `next()`, of merged exposures. sent: levels of all fixtures, as they were. Refused, in words, if it
  /// does not tell where the camera is.
  [[nodiscard]] Result<void> take(std::span<const double> sent, const MergedPicture& picture);
  /// In place of take(), for a lamp alone that gives hardly any light where this camera looks.
  void skip(std::span<const double> sent);

  /// After the first picture.
  [[nodiscard]] const std::optional<FoundCamera>& found() const { return found_; }
  /// It was found from where an earlier calibration had found it.
  [[nodiscard]] bool found_as_before() const { return found_as_before_; }
  /// Call these when all is measured. first_receiver: of the first place.
  [[nodiscard]] const std::vector<LampCurve>& curves() const { return curves_; }
  [[nodiscard]] const CameraOverflow& overflow() const { return overflow_; }
  /// curves: per fixture, such as curves(), or those that several cameras found together.
  [[nodiscard]] std::vector<LightReading> readings(const CameraInstrument& camera, std::size_t first_receiver,
                                                   std::span<const LampCurve> curves) const;

 private:
  struct Taken {
    double level = 0;  ///< of the step's fixture, as sent
    std::vector<std::optional<SeenLight>> light;
  };
  [[nodiscard]] bool first_of_lamp(std::size_t step) const;
  void find_curves();
  [[nodiscard]] LampCurve curve_from(std::size_t first) const;
  [[nodiscard]] Result<void> look_for_camera(const Picture& picture);
  /// Without what is full.
  [[nodiscard]] std::vector<std::optional<SeenLight>> light_in(const MergedPicture& picture);

  const Rig* rig_;
  const RayScene* rays_;
  CameraStart start_;
  std::span<const SeenPlace> stated_places_;
  std::vector<double> brightest_;
  std::vector<LampStep> plan_;
  std::optional<FoundCamera> found_;
  bool found_as_before_ = false;
  CameraOverflow overflow_;
  std::size_t pictures_of_lamps_ = 0;
  std::vector<std::optional<SeenPlace>> places_;
  Picture dark_;
  std::vector<Taken> taken_;
  std::vector<LampCurve> curves_;
};

}  // namespace luxrig
