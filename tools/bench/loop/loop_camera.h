#pragma once
/// The bench's cameras: those of a simulated rig, as wrong as the truth has them, and what follows from their pictures.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/calibration/camera_instrument.h"
#include "core/calibration/seen_places.h"
#include "core/tasks/session.h"
#include "sim/devices/camera.h"
#include "sim/world/world.h"

namespace luxrig {

/// What one camera sees of the rig as stated.
struct SeenBy {
  PictureCamera camera;
  std::vector<SeenPlace> places;
  std::size_t first_point = 0;  ///< of its places, in SeenRig::session
};
struct SeenRig {
  std::vector<SeenBy> each;  ///< the cameras of the rig file, or one that sees most of the room if it has none
  std::size_t places = 0;    ///< of all
  Session session;           ///< of the rig with a point at each place, after its own
};
[[nodiscard]] Result<SeenRig> see(const Session& session);

/// What it saw of a true rig, by the camera that was found.
struct Photographed {
  std::vector<std::optional<SeenPlace>> places;
  std::vector<std::vector<std::optional<SeenLight>>> of_lamp;  ///< per fixture
  std::optional<double> stated_off_px, off_px;  ///< median over what is seen: stated and found against the true camera
  std::string refused;                          ///< why the camera was not found; then there are no lights
};

/// Takes pictures of a simulated rig as it is at that moment.
class Photographer {
 public:
  /// All arguments outlive it.
  /// index: of the camera, as its error is drawn.
  Photographer(const SeenBy& seen, std::size_t index, const Session& stated, const sim::World& world,
               const RayScene& true_rays, const sim::Deviations& deviations);
  /// With every lamp lit: finds the camera.
  [[nodiscard]] Result<void> look();
  /// With this fixture lit alone.
  [[nodiscard]] Result<void> take(std::size_t fixture);
  [[nodiscard]] const Photographed& taken() const { return taken_; }

 private:
  [[nodiscard]] Result<Picture> bracket();

  const SeenBy& seen_;
  const Session& stated_;
  const sim::World& world_;
  const RayScene& true_rays_;
  std::uint64_t seed_, shots_ = 0;
  sim::CameraTruth truth_;
  Photographed taken_;
};

}  // namespace luxrig
