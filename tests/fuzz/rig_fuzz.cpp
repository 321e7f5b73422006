// Any bytes as a rig file, in a folder without other files: never a crash; a Rig that keeps its promises, or problems
// that can be shown to a person.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>

#include "core/check.h"
#include "core/output/keep_out.h"
#include "core/rig/rig_file.h"
#include "core/tasks/rig_transport.h"
#include "core/text/plain_text.h"

namespace {

std::filesystem::path empty_folder() {
  const auto folder = std::filesystem::temp_directory_path() / "luxrig_rig_fuzz";
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path folder = empty_folder();
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto rig = luxrig::parse_rig(text, "fuzz.toml", folder);
  if (!rig) {
    LUXRIG_CHECK(!rig.error().empty(), "refused without a problem");
    for (const luxrig::Problem& problem : rig.error()) {
      LUXRIG_CHECK(!problem.what.empty() && !problem.mend.empty(), "{}", problem.text());
      LUXRIG_CHECK(luxrig::is_plain_text(problem.text()), "{}", problem.text());
      LUXRIG_CHECK(problem.line > 0 || problem.what.find("bytes") != std::string::npos ||
                       problem.what.find("more problems") != std::string::npos,
                   "{}", problem.text());
    }
    return 0;
  }
  for (const luxrig::Luminaire& luminaire : rig->luminaires) {
    LUXRIG_CHECK(luminaire.intensity != nullptr && luminaire.lumens > 0, "{}", luminaire.name);
  }
  for (const luxrig::Fixture& fixture : rig->fixtures) {
    LUXRIG_CHECK(fixture.luminaire < rig->luminaires.size() && fixture.bus < rig->buses.size(), "{}", fixture.name);
    LUXRIG_CHECK(fixture.world_from_lamp().rotation.allFinite(), "{}", fixture.name);
    LUXRIG_CHECK(fixture.world_from_mount.translation_m.allFinite(), "{}", fixture.name);
    LUXRIG_CHECK(!fixture.moves || (fixture.pan_speed_rad_s > 0 && fixture.tilt_speed_rad_s > 0), "{}", fixture.name);
  }
  for (const luxrig::Fixture& fixture : rig->fixtures) {
    LUXRIG_CHECK(fixture.stage >= 1 && fixture.reset_s >= 0 && (fixture.moves || !fixture.park), "{}", fixture.name);
    LUXRIG_CHECK(!fixture.park || (fixture.park->pan_rad >= fixture.range.pan_min_rad - 1e-9 &&
                                   fixture.park->pan_rad <= fixture.range.pan_max_rad + 1e-9),
                 "{}", fixture.name);
  }
  for (const luxrig::KeepOut& zone : rig->keep_outs) {
    LUXRIG_CHECK(zone.box_world_m ? !zone.box_world_m->isEmpty() : zone.radius_m > 0, "{}", zone.name);
    LUXRIG_CHECK(!zone.heads.empty() && std::is_sorted(zone.heads.begin(), zone.heads.end()), "{}", zone.name);
    for (const std::size_t head : zone.heads) LUXRIG_CHECK(rig->fixtures.at(head).moves, "{}", zone.name);
  }
  const luxrig::KeepOutZones zones(*rig);
  for (const std::size_t head : zones.heads()) {
    const luxrig::Joints& looks = rig->fixtures[head].joints;
    LUXRIG_CHECK(!zones.met(head, looks) || zones.may_meet(head, luxrig::JointBox::at(looks)), "{}",
                 rig->fixtures[head].name);
  }
  for (const luxrig::Luxmeter& meter : rig->luxmeters) {
    LUXRIG_CHECK(meter.bus < rig->buses.size(), "{}", meter.name);
    LUXRIG_CHECK(!meter.point || *meter.point < rig->points.size(), "{}", meter.name);
    LUXRIG_CHECK(std::abs(meter.normal_world.norm() - 1) < 1e-9, "{}", meter.name);
  }
  for (const luxrig::Point& point : rig->points) {
    LUXRIG_CHECK(point.position_world_m.allFinite(), "{}", point.name);
    LUXRIG_CHECK(std::abs(point.normal_world.norm() - 1) < 1e-9, "{}", point.name);
  }
  if (rig->daylight) {
    const luxrig::Daylight& d = *rig->daylight;
    LUXRIG_CHECK(std::abs(d.towards_sun_world.norm() - 1) < 1e-9, "sun");
    LUXRIG_CHECK(d.sky == luxrig::Daylight::SkyKind::none || d.horizontal_lx > 0, "{} lx", d.horizontal_lx);
    LUXRIG_CHECK(d.sun_normal_lx >= 0 && d.sun_normal_lx <= 200'000, "{} lx", d.sun_normal_lx);
    LUXRIG_CHECK(d.general_type >= 1 && d.general_type <= 15, "{}", d.general_type);
    static_cast<void>(luxrig::daylight_emitters_of(*rig));  // must succeed
  }
  LUXRIG_CHECK(!rig->tasks.empty(), "no task");
  return 0;
}
