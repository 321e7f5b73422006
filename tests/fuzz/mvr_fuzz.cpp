// Any bytes as the scene of an MVR file: never a crash; problems that can be shown to a person, or a rig file that
// reads, with every fixture in its place.
#include <cstdint>
#include <filesystem>

#include "core/rig/mvr/mvr_rig.h"
#include "core/rig/rig_file.h"
#include "tests/fuzz/personality_properties.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  auto scene = luxrig::parse_mvr_scene(text, "fuzz.xml");
  if (!scene) {
    luxrig::fuzz::check_problems(scene.error());
    return 0;
  }
  const luxrig::ImportedRig imported = luxrig::rig_of_mvr({*scene, {}}, "fuzz");
  const auto rig = luxrig::parse_rig(imported.rig_toml, "rig.toml", std::filesystem::temp_directory_path());
  LUXRIG_CHECK(rig.has_value(), "{}\n{}", rig ? "" : rig.error().front().text(), imported.rig_toml);
  LUXRIG_CHECK(rig->fixtures.size() == scene->fixtures.size(), "{} fixtures", rig->fixtures.size());
  for (std::size_t i = 0; i < rig->fixtures.size(); ++i) {
    const double off_m =
        (rig->fixtures[i].world_from_mount.translation_m - scene->fixtures[i].world_from_base.translation_m)
            .cwiseAbs()
            .maxCoeff();
    LUXRIG_CHECK(off_m <= 1e-4, "{} m", off_m);
  }
  return 0;
}
