#pragma once
/// What a rig gives, kept in its state folder, so that a daemon that starts again need not trace it again before there
/// is light.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/show/show_controller.h"
#include "core/tasks/session.h"

namespace luxrig {

struct KeptLight {
  std::vector<Joints> joints;  ///< per fixture: where heads look in it
  LightModel model;
};

/// What it depends on: the rig and its scene (RigVersion::light), how it was asked for, and this program.
[[nodiscard]] std::uint64_t light_key(const Rig& rig, const Scene& scene, const ComputeOptions& compute);

/// What the last word of its bytes says of the words before: tells a torn or rotten file, not a forged one.
[[nodiscard]] std::uint64_t light_sum(std::span<const std::uint64_t> words);

/// Bytes and back; nothing where they are damaged, of another key, or of other sizes than the rig's.
[[nodiscard]] std::string light_bytes(const KeptLight& light, std::uint64_t key);
[[nodiscard]] std::optional<KeptLight> light_of_bytes(std::string_view bytes, std::uint64_t key, const Rig& rig);

/// light.bin in the folder. That it cannot be written is no harm: the next start takes longer.
void keep_light(const std::filesystem::path& folder, const KeptLight& light, std::uint64_t key);
[[nodiscard]] std::optional<KeptLight> kept_light(const std::filesystem::path& folder, std::uint64_t key,
                                                  const Rig& rig);

}  // namespace luxrig
