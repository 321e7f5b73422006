#pragma once
/// The rig's light model, kept in its state folder, so that a restarted daemon has light without tracing it again.

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
  std::vector<Joints> joints;  ///< per fixture: the aims that the model holds for
  LightModel model;
};

/// Hash of all inputs of the model: the rig and its scene (RigVersion::light), the compute options, and the program
/// that is to use it: this one, or another of the same build.
[[nodiscard]] std::uint64_t light_key(const Rig& rig, const Scene& scene, const ComputeOptions& compute,
                                      const std::filesystem::path& program = "/proc/self/exe");

/// Checksum over the words, stored as the last word. It detects a torn or rotten file, not a forged one.
[[nodiscard]] std::uint64_t light_sum(std::span<const std::uint64_t> words);

/// Bytes and back. nullopt if they are damaged, have another key, or other sizes than the rig.
[[nodiscard]] std::string light_bytes(const KeptLight& light, std::uint64_t key);
[[nodiscard]] std::optional<KeptLight> light_of_bytes(std::string_view bytes, std::uint64_t key, const Rig& rig);

/// Reads and writes light.bin in the folder. A failed write does no harm: the next start takes longer.
void keep_light(const std::filesystem::path& folder, const KeptLight& light, std::uint64_t key);
[[nodiscard]] std::optional<KeptLight> kept_light(const std::filesystem::path& folder, std::uint64_t key,
                                                  const Rig& rig);

}  // namespace luxrig
