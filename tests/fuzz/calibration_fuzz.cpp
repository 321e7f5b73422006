// Any bytes as a calibration: never a throw; an accepted one is written and read back the same, and laid over a rig.
#include <cmath>
#include <cstdint>
#include <string>

#include "core/calibration/camera_offset.h"
#include "core/check.h"
#include "core/estimation/calibration.h"
#include "core/output/dimming.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto read = luxrig::calibration_from_json(std::string(reinterpret_cast<const char*>(data), size), "fuzz.json");
  if (!read) {
    LUXRIG_CHECK(!read.error().empty(), "refused without a problem");
    for (const luxrig::Problem& problem : read.error())
      LUXRIG_CHECK(!problem.what.empty() && !problem.mend.empty(), "a problem without text");
    return 0;
  }
  const std::string written = luxrig::to_json(*read);
  const auto again = luxrig::calibration_from_json(written, "again.json");
  LUXRIG_CHECK(again.has_value(), "own output refused: {}", again.error()[0].text());
  LUXRIG_CHECK(luxrig::to_json(*again) == written, "not the same when written again");

  luxrig::Rig rig;
  rig.name = read->rig;
  rig.luminaires.resize(1);
  rig.luminaires[0].intensity = luxrig::make_isotropic(1000);
  for (const luxrig::CalibratedFixture& fixture : read->fixtures) {
    rig.fixtures.emplace_back();
    rig.fixtures.back().name = fixture.name;
  }
  const auto applied = luxrig::calibrated(rig, *read, "fuzz.json");
  LUXRIG_CHECK(applied.has_value(), "refused by its own rig");
  for (const luxrig::Fixture& fixture : applied->fixtures) {
    LUXRIG_CHECK(applied->luminaires[fixture.luminaire].intensity->flux_lm() > 0, "a lamp without light");
    LUXRIG_CHECK(fixture.world_from_mount.translation_m.allFinite(), "a lamp nowhere");
    for (const double level : {0.0, 0.001, 0.3, 1.0}) {
      const double drive = luxrig::drive_for(fixture, level);
      LUXRIG_CHECK(drive >= 0 && drive <= 1, "drive {} for level {}", drive, level);
    }
  }
  for (const luxrig::CalibratedCamera& camera : read->cameras) {
    const luxrig::Camera view = luxrig::view_of(luxrig::PictureCamera{}, camera);
    LUXRIG_CHECK(luxrig::ray_direction(view, 0, 0).allFinite(), "a camera that looks nowhere");
    LUXRIG_CHECK(view.vertical_fov_rad > 0 && view.vertical_fov_rad < luxrig::kPi, "a field of view of {}",
                 view.vertical_fov_rad);
  }
  return 0;
}
