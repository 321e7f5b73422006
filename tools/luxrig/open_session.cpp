#include "tools/luxrig/open_session.h"

#include <fmt/format.h>

#include <cstdio>
#include <system_error>

#include "core/estimation/calibration.h"
#include "core/rig/rig_file.h"
#include "drivers/camera/camera_source.h"
#include "drivers/registry.h"
#include "tools/process/files.h"
#include "tools/process/utc_time.h"

namespace luxrig {
namespace {

Checked<Rig> stated_rig(const std::filesystem::path& path) {
  auto rig = load_rig(path);
  if (!rig) return rig;
  if (auto problems = check_buses(*rig); !problems.empty()) return tl::unexpected(std::move(problems));
  if (auto problems = check_cameras(*rig); !problems.empty()) return tl::unexpected(std::move(problems));
  return rig;
}

}  // namespace

Checked<Rig> with_calibration(Rig rig) {
  const std::filesystem::path file = calibration_file(rig);
  std::error_code error;
  if (!std::filesystem::exists(file, error) && !error) return rig;
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  const auto calibration = calibration_from_json(*text, file.string());
  if (!calibration) return tl::unexpected(calibration.error());
  auto found = calibrated(std::move(rig), *calibration, file.string());
  if (found) found->calibrated_hours_ago = hours_since(calibration->made);
  return found;
}

void tell_calibration(const Rig& rig) {
  if (rig.calibrated.empty()) return;
  fmt::print(stderr, "luxrig: as calibrated {} ({}){}\n", rig.calibrated, calibration_file(rig).string(),
             rig.calibrated_on.empty()
                 ? ""
                 : fmt::format(": of a simulated rig ({}), not of the real one", rig.calibrated_on));
}

Checked<Session> open_session(const std::filesystem::path& rig_path) {
  auto rig = stated_rig(rig_path);
  if (rig) rig = with_calibration(std::move(*rig));
  if (!rig) return tl::unexpected(std::move(rig.error()));
  return session_of(std::move(*rig));
}

Checked<Session> open_stated_session(const std::filesystem::path& rig_path) {
  auto rig = stated_rig(rig_path);
  if (!rig) return tl::unexpected(std::move(rig.error()));
  return session_of(std::move(*rig));
}

}  // namespace luxrig
