#pragma once
/// Maker's fixture files: GDTF (.gdtf) and Open Fixture Library (.json).

#include <filesystem>
#include <memory>

#include "core/result.h"
#include "core/rig/personality/personality.h"

namespace luxrig {

/// Problems name the file, and the place in it if known.
[[nodiscard]] Checked<Personality> load_personality(const std::filesystem::path& path);

}  // namespace luxrig
